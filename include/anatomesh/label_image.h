// A segmented image in memory.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "anatomesh/label_table.h"
#include "anatomesh/types.h"

namespace anatomesh {

/// A 3D array of labels and where it lies in space. The centre of voxel (i, j, k) is at
/// origin + direction * (i * spacing.x, j * spacing.y, k * spacing.z) in LPS millimetres.
struct LabelImage {
  std::array<std::size_t, 3> size = {0, 0, 0};  ///< voxels along i, j, k
  Vec3 spacing_mm = {1, 1, 1};                  ///< distance of voxel centres along i, j, k; > 0
  Vec3 origin_mm;                               ///< centre of voxel (0, 0, 0), LPS
  Mat3 direction = kIdentity3;                  ///< column a: unit vector of index axis a in LPS; orthonormal
  std::vector<Label> voxels;                    ///< size[0]*size[1]*size[2] labels, i fastest
  LabelTable names = {};                        ///< of the labels, where they are known

  Label at(std::size_t i, std::size_t j, std::size_t k) const { return voxels[i + size[0] * (j + size[1] * k)]; }
};

}  // namespace anatomesh
