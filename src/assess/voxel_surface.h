// The boundary of a block of voxels: distances to it, and samples on it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "anatomesh/types.h"
#include "assess/voxel_block.h"

namespace anatomesh::assess_detail {

/// A side of a voxel of the block with the tissue on one of its sides only.
struct VoxelSide {
  std::array<std::int32_t, 3> voxel;  ///< index in the image of the one on the lower side
  std::int32_t axis;                  ///< across the side
};

/// All of them. Cost: a nanosecond or two a voxel.
std::vector<VoxelSide> boundary_of(const VoxelBlock& block);

/// Distances from any point to the boundary of a block. Positions are in voxel indices of the image times the spacing.
///
/// From inside a voxel of one state (tissue or not) the nearest boundary point is the nearest point of the voxels of
/// the other state. So a query asks for those: first among the neighbours of its own voxel, where nearly every query
/// ends; then in a pyramid of ever coarser cells that know which states they hold.
class VoxelDistance {
 public:
  /// The block must outlive this. Cost: about a nanosecond a voxel, and a third of the block's memory.
  VoxelDistance(const VoxelBlock& block, Vec3 spacing_mm);

  /// Squared distance if it is below reach_squared, else some value that is not.
  double distance_squared(Vec3 p_mm, double reach_squared) const;

 private:
  static constexpr std::uint8_t kOther = 1, kTissue = 2;  // states, as bits: a cell may hold both

  struct Level {
    std::array<std::int64_t, 3> size;
    std::vector<std::uint8_t> states;
  };
  struct Cell {
    std::size_t level;  // 0: voxels
    std::array<std::int64_t, 3> at;
  };

  struct Waiting {
    Cell cell;
    double distance_squared;
  };
  struct Search {
    Vec3 p;
    std::uint8_t wanted;
    double reach_squared;
    std::size_t waiting = 0;
    // At most eight cells to begin with, and seven more that wait at each level. Not cleared: that would take longer
    // than the search.
    std::array<Waiting, 8 * 40> stack;

    Search(Vec3 p_, std::uint8_t wanted_, double reach_squared_)
        : p(p_), wanted(wanted_), reach_squared(reach_squared_) {}
  };

  const std::array<std::int64_t, 3>& size_of(std::size_t level) const;
  std::uint8_t states(const Cell& cell) const;
  double box_distance_squared(const Cell& cell, Vec3 p) const;
  double nearest_neighbour(const std::array<std::int64_t, 3>& voxel, Vec3 p, std::uint8_t own) const;
  double search_pyramid(Vec3 p, std::uint8_t wanted, double reach_squared) const;
  void push_cells_in_reach(Search& search) const;
  void look_into(const Cell& cell, Search& search) const;

  const VoxelBlock& block_;
  Vec3 spacing_;
  double smallest_spacing_;
  std::vector<Level> levels_;  // levels_[n]: cells of 2^(n + 1) voxels a side; the last has one cell
};

}  // namespace anatomesh::assess_detail
