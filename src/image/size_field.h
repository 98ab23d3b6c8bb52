// How long edges may be, tissue by tissue and place by place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/vec.h"
#include "image/tissue_image.h"

namespace anatomesh {

inline constexpr double kNoSize = std::numeric_limits<double>::infinity();

/// The longest edges wanted inside the tissues. Holds a reference to the image, which must outlive it.
struct SizeField {
  const TissueImage& image;
  std::vector<double> of_tissue_mm;  ///< by tissue, infinite where not asked; empty: for none
  std::vector<float> of_voxel_mm;    ///< by voxel, infinite where not asked; empty: for none

  bool empty() const { return of_tissue_mm.empty() && of_voxel_mm.empty(); }

  /// Around a voxel (an offset in the image).
  double at_voxel(std::size_t voxel) const {
    const double size = of_voxel_mm.empty() ? kNoSize : static_cast<double>(of_voxel_mm[voxel]);
    return of_tissue_mm.empty() ? size : std::min(size, of_tissue_mm[image.voxels[voxel]]);
  }

  /// In a tissue of the mesh at p (mm): the voxel there counts where it is of that tissue.
  double at(TissueId tissue, Vec3 p) const {
    double size = of_tissue_mm.empty() ? kNoSize : of_tissue_mm[tissue];
    if (of_voxel_mm.empty() || tissue == 0) return size;
    std::array<int, 3> index;
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = static_cast<int>(std::lround(p[a] / image.spacing_mm[a]) - image.first[a]);
    if (image.at_or_background(index[0], index[1], index[2]) != tissue) return size;
    return std::min(size, static_cast<double>(of_voxel_mm[image.offset(index[0], index[1], index[2])]));
  }
};

}  // namespace anatomesh
