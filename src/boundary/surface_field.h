// The field whose levels are the smooth boundaries that the mesh is settled on.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// u_t(p) = sum over the voxels v of tissue t of weight(v) B(p - v), where B is the separable cubic B-spline of one
/// voxel's width (support: 4 x 4 x 4 voxels). The boundary of tissues a and b is where u_a = u_b.
class SurfaceField {
 public:
  explicit SurfaceField(const TissueImage& image);

  /// Value and gradient (per mm) of u_t at p for each of `tissues`, written to the same places of the other two.
  /// p is in the image's frame, mm; any finite point is allowed.
  void evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values, std::span<Vec3> gradients) const;

  const TissueImage& image() const { return *image_; }
  double weight(int i, int j, int k) const;

 private:
  const TissueImage* image_;
  Vec3 voxels_per_mm_;
  Vec3 first_;
  std::vector<std::uint8_t> weights_;
};

}  // namespace anatomesh
