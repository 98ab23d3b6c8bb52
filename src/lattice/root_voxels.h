// The voxels of an image, sorted into the root tetrahedra of a lattice that hold their centres.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace anatomesh {

/// Offsets in the image, grouped by the slots of level 0: those of slot s are order[begin[s]] up to order[begin[s + 1]]
/// (excluded), in ascending order.
struct RootVoxels {
  std::vector<std::uint32_t> begin, order;
};

/// position: of voxel centres along each axis, ascending, in units of level 0. Voxels outside of the lattice are left
/// out. Cost: two passes over the voxels, some 3 ns each.
RootVoxels sort_into_roots(const std::array<std::vector<double>, 3>& position,
                           const std::array<std::int32_t, 3>& root_cells);

}  // namespace anatomesh
