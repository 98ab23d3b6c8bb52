// The voxels of one tissue (or of all) in the box that holds them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "assess/rasterise.h"

namespace anatomesh::assess_detail {

struct VoxelBlock {
  static constexpr std::int64_t kPad = 2;  ///< empty voxels on each side

  std::array<std::int64_t, 3> first = {0, 0, 0};  ///< index in the image of voxel (0, 0, 0); may be negative
  std::array<std::int64_t, 3> size = {0, 0, 0};
  std::vector<std::uint8_t> inside;  ///< 1 where the voxel belongs to the tissue, i fastest

  std::size_t offset(std::int64_t i, std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(i + size[0] * (j + size[1] * k));
  }
};

/// The voxels in `range` (not empty) that carry the label; any label but 0 for label 0.
VoxelBlock cut_out(const LabelImage& image, const VoxelRange& range, Label label);

/// Parts of the block connected by sides.
std::uint64_t count_components_6(const VoxelBlock& block);

/// Parts of the block connected by sides, edges or corners.
std::uint64_t count_components_26(const VoxelBlock& block);

/// Euler number of the union of the closed voxels.
std::int64_t euler_number(const VoxelBlock& block);

}  // namespace anatomesh::assess_detail
