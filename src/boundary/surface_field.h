// The field whose levels are the smooth boundaries that the mesh is settled on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// u_t(p) = sum over the voxels v of tissue t of weight(v) B(p - v), where B is the separable cubic B-spline of one
/// voxel's width along each axis (support: 4 x 4 x 4 voxels) and the weights are those of voxel_weights(). The boundary
/// of tissues a and b is where u_a = u_b. At the border of the original image the tissues go on, mirrored.
///
/// Holds a reference to the image, which must outlive it, and a byte a voxel. All functions may be called by several
/// threads at once.
class SurfaceField {
 public:
  explicit SurfaceField(const TissueImage& image);

  /// With weights that are known already, those of voxel_weights().
  SurfaceField(const TissueImage& image, std::vector<std::uint8_t> weights);

  /// Value and gradient (per mm) of u_t at p for each of `tissues`, written to the same places of the other two.
  /// p is in the image's frame, mm; any finite point is allowed. Cost: about 50 ns and 50 ns
  /// a tissue (the voxels in cache).
  void evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values, std::span<Vec3> gradients) const;

  struct Value {
    double value;
    Vec3 gradient;  ///< per mm
  };
  /// u_b - u_a at p: 0 on the boundary of a and b. As evaluate() for one tissue.
  Value difference(Vec3 p, TissueId a, TissueId b) const;

  const TissueImage& image() const { return *image_; }
  const std::vector<std::uint8_t>& weights() const { return weights_; }

 private:
  struct Near;
  using Sums = std::array<double, 4>;  // value, then gradient, per voxel
  Near voxels_near(Vec3 p) const;
  static Sums sum_up(const Near& near, const std::array<std::int16_t, 64>& share);
  Value scaled(const Sums& sums) const;

  const TissueImage* image_;
  Vec3 voxels_per_mm_;
  Vec3 first_;
  std::vector<std::uint8_t> weights_;
};

}  // namespace anatomesh
