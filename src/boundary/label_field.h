// The smoothed label field: for each tissue the share of it around a point, as a smooth function.
#pragma once

#include <span>

#include "image/tissue_image.h"

namespace anatomesh {

/// u_t(p) = sum over the voxels v of tissue t of w(p - v), where w is the separable cubic B-spline of one
/// voxel's width along each axis (support: 4 x 4 x 4 voxels). For every p the u_t are in [0, 1] and add up to 1;
/// each is twice continuously differentiable. Outside the crop all is background. The level u_a = u_b is the
/// sub-voxel boundary of tissues a and b; a sheet one voxel thick keeps its place (u = 2/3 in its middle).
///
/// Holds a reference to the image, which must outlive it. All functions may be called by several threads at once.
class LabelField {
 public:
  explicit LabelField(const TissueImage& image);

  /// Value and gradient (per mm) of u_t at p for each of `tissues`, written to the same places of the other two.
  /// p is in the image's frame, mm; any finite point is allowed. Cost: about 30 ns and 25 ns a tissue
  /// (the voxels in cache).
  void evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values, std::span<Vec3> gradients) const;

  /// The tissue with the largest u at p (mm); of equal ones (to 1e-12) the lowest. Cost: about 70 ns.
  TissueId label_at(Vec3 p) const;

  const TissueImage& image() const { return *image_; }

 private:
  const TissueImage* image_;
  Vec3 voxels_per_mm_;
  Vec3 first_;  // index in the original image of voxel (0, 0, 0), as reals
};

}  // namespace anatomesh
