// Which tetrahedron of a mesh holds each voxel centre of a grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "anatomesh/types.h"

namespace anatomesh {

using GridSize = std::array<std::size_t, 3>;  ///< voxels along each axis

inline constexpr TetId kNoTet = ~TetId{0};

/// A few slices of the grid, i fastest.
struct OwnedSlices {
  static constexpr std::int64_t kMost = 4;  ///< slices at once, fewer at the grid's end

  std::size_t first = 0;         ///< the first of the slices; a multiple of kMost
  std::span<const TetId> owner;  ///< by voxel of these slices; kNoTet: none
  std::span<const std::uint8_t>
      holders;  ///< tetrahedra that hold the centre strictly inside; 2 stands for more as well
};

/// Calls visit(slices) for all slices of the grid, several at once and in no fixed order. A centre belongs to the first
/// tetrahedron that holds it strictly inside, else to the first that it touches; tetrahedra without volume hold none.
/// points_vox: the mesh's points in voxel indices. Throws Cancelled.
/// Cost: some nanoseconds a voxel and about a microsecond a tetrahedron; memory: five bytes a voxel of the few
/// slices that each thread works on.
void for_each_owned_slices(std::span<const Vec3> points_vox, std::span<const std::array<VertexId, 4>> tets,
                           const GridSize& size, const std::stop_token& cancel,
                           const std::function<void(const OwnedSlices&)>& visit);

}  // namespace anatomesh
