// How long edges may be around the boundaries that a change of the image makes.
#pragma once

#include <span>
#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// A place that takes smaller edges than the boundary around it.
struct FinePlace {
  Vec3 at_mm;
  double size_mm;
};

class PatchSizes {
 public:
  /// surface_mm: size along the surface of each tissue, by tissue, [0] unused. is_changed: by voxel of the image; only
  /// boundaries there count. Cost: some ten nanoseconds a voxel.
  PatchSizes(const TissueImage& image, std::span<const double> surface_mm, const std::vector<char>& is_changed,
             std::span<const FinePlace> fine = {});

  /// The size of the nearest such boundary, and more the farther it is (mm).
  double at(Vec3 p_mm) const;

 private:
  const TissueImage& image_;
  std::vector<float> size_mm_;
};

}  // namespace anatomesh
