#include "assess/voxel_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

/// Sides between voxels of slice k and those next to them in positive direction.
void sides_of_slice(const VoxelBlock& block, std::int64_t k, std::vector<VoxelSide>& sides) {
  const std::array<std::int64_t, 3> step = {1, block.size[0], block.size[0] * block.size[1]};
  for (std::int64_t j = 0; j + 1 < block.size[1]; ++j) {
    const std::uint8_t* row = &block.inside[block.offset(0, j, k)];
    for (std::int64_t i = 0; i + 1 < block.size[0]; ++i) {
      for (std::int32_t axis = 0; axis < 3; ++axis) {
        if (row[i] == row[i + step[static_cast<std::size_t>(axis)]]) continue;
        sides.push_back({{static_cast<std::int32_t>(i + block.first[0]), static_cast<std::int32_t>(j + block.first[1]),
                          static_cast<std::int32_t>(k + block.first[2])},
                         axis});
      }
    }
  }
}

}  // namespace

std::vector<VoxelSide> boundary_of(const VoxelBlock& block) {
  const auto slices = static_cast<std::size_t>(block.size[2] - 1);
  std::vector<std::vector<VoxelSide>> parts(slices);
  parallel_for(
      slices, [&](std::size_t k) { sides_of_slice(block, static_cast<std::int64_t>(k), parts[k]); }, 4);
  std::vector<VoxelSide> sides;
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  sides.reserve(count);
  for (const auto& part : parts) sides.insert(sides.end(), part.begin(), part.end());
  return sides;
}

VoxelDistance::VoxelDistance(const VoxelBlock& block, Vec3 spacing_mm)
    : block_(block), spacing_(spacing_mm), smallest_spacing_(std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z})) {
  auto below = block.size;
  while (below[0] > 1 || below[1] > 1 || below[2] > 1) {
    Level level;
    for (std::size_t a = 0; a < 3; ++a) level.size[a] = (below[a] + 1) / 2;
    level.states.assign(static_cast<std::size_t>(level.size[0] * level.size[1] * level.size[2]), 0);
    parallel_for(
        static_cast<std::size_t>(level.size[2]),
        [&](std::size_t slice) {
          const auto k0 = 2 * static_cast<std::int64_t>(slice);
          for (std::int64_t k = k0; k < std::min(k0 + 2, below[2]); ++k) {
            for (std::int64_t j = 0; j < below[1]; ++j) {
              std::uint8_t* row =
                  &level.states[static_cast<std::size_t>(level.size[0] * (j / 2 + level.size[1] * (k / 2)))];
              for (std::int64_t i = 0; i < below[0]; ++i) row[i / 2] |= states({levels_.size(), {i, j, k}});
            }
          }
        },
        8);
    below = level.size;
    levels_.push_back(std::move(level));
  }
}

const std::array<std::int64_t, 3>& VoxelDistance::size_of(std::size_t level) const {
  return level == 0 ? block_.size : levels_[level - 1].size;
}

std::uint8_t VoxelDistance::states(const Cell& cell) const {
  const auto [i, j, k] = cell.at;
  if (cell.level == 0) return block_.inside[block_.offset(i, j, k)] ? kTissue : kOther;
  const Level& level = levels_[cell.level - 1];
  return level.states[static_cast<std::size_t>(i + level.size[0] * (j + level.size[1] * k))];
}

double VoxelDistance::box_distance_squared(const Cell& cell, Vec3 p) const {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t low = cell.at[a] << cell.level, high = (cell.at[a] + 1) << cell.level;
    const double below = (static_cast<double>(low) - 0.5) * spacing_[a] - p[a];
    const double above = p[a] - (static_cast<double>(high) - 0.5) * spacing_[a];
    const double d = below > above ? below : above;
    if (d > 0) sum += d * d;
  }
  return sum;
}

double VoxelDistance::distance_squared(Vec3 p_mm, double reach_squared) const {
  Vec3 p;  // relative to the centre of voxel (0, 0, 0) of the block
  std::array<std::int64_t, 3> voxel;
  bool in_block = true, has_neighbours = true;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = p_mm[a] - static_cast<double>(block_.first[a]) * spacing_[a];
    const double index = std::floor(p[a] / spacing_[a] + 0.5);
    in_block = in_block && index >= 0 && index < static_cast<double>(block_.size[a]);
    has_neighbours = has_neighbours && index >= 1 && index + 1 < static_cast<double>(block_.size[a]);
    voxel[a] = in_block ? static_cast<std::int64_t>(index) : 0;
  }
  const std::uint8_t own = in_block ? states({0, voxel}) : kOther;
  if (has_neighbours) {
    const double found = nearest_neighbour(voxel, p, own);
    // All else is at least a whole voxel away.
    if (found <= smallest_spacing_ * smallest_spacing_) return found;
    reach_squared = std::min(reach_squared, std::nextafter(found, std::numeric_limits<double>::infinity()));
  }
  return search_pyramid(p, own == kTissue ? kOther : kTissue, reach_squared);
}

/// Squared distance to the nearest of the 26 neighbours that is not in the state `own`.
double VoxelDistance::nearest_neighbour(const std::array<std::int64_t, 3>& voxel, Vec3 p, std::uint8_t own) const {
  std::array<std::array<double, 3>, 3> gap;  // [axis][step + 1]: squared distance along it to the voxels at that step
  for (std::size_t a = 0; a < 3; ++a) {
    const double from_low = p[a] - (static_cast<double>(voxel[a]) - 0.5) * spacing_[a];
    const double to_high = spacing_[a] - from_low;
    gap[a] = {from_low * from_low, 0, to_high * to_high};
  }
  const std::uint8_t same = own == kTissue;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      const double across = gap[1][j] + gap[2][k];
      const std::uint8_t* row = &block_.inside[block_.offset(voxel[0] - 1, voxel[1] - 1 + static_cast<std::int64_t>(j),
                                                             voxel[2] - 1 + static_cast<std::int64_t>(k))];
      for (std::size_t i = 0; i < 3; ++i) {
        const double d = across + gap[0][i];
        if (row[i] != same && d < nearest) nearest = d;
      }
    }
  }
  return nearest;
}

double VoxelDistance::search_pyramid(Vec3 p, std::uint8_t wanted, double reach_squared) const {
  Search search(p, wanted, reach_squared);
  push_cells_in_reach(search);
  while (search.waiting > 0) {
    const auto [cell, distance_squared] = search.stack[--search.waiting];
    if (distance_squared >= search.reach_squared) continue;
    if (cell.level == 0) {
      search.reach_squared = distance_squared;
    } else {
      look_into(cell, search);
    }
  }
  return search.reach_squared;
}

/// Remembers the children of a cell that may hold something nearer, the one on the side of p last, so that it is taken
/// first. Children that are voxels are looked at right away.
void VoxelDistance::look_into(const Cell& cell, Search& search) const {
  const std::size_t level = cell.level - 1;
  const double width = static_cast<double>(std::int64_t{1} << level);
  std::array<std::array<std::int64_t, 2>, 3> at;  // [axis]: index of the half near p, of the far one
  std::array<std::array<double, 2>, 3> gap;       // and the squared distance along the axis to each
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int64_t first = 2 * cell.at[a];
    const double size = width * spacing_[a];
    const double past_middle = search.p[a] - (width * static_cast<double>(first + 1) - 0.5) * spacing_[a];
    const bool far_side = past_middle >= 0;
    const double past_end = std::abs(past_middle) - size;
    at[a] = {first + far_side, first + !far_side};
    gap[a] = {past_end > 0 ? past_end * past_end : 0, past_middle * past_middle};
  }
  const auto& size = size_of(level);
  for (std::size_t n = 0; n < 8; ++n) {
    const std::size_t away = level == 0 ? n : 7 - n;
    const std::size_t x = away & 1, y = away >> 1 & 1, z = away >> 2;
    const double d = gap[0][x] + gap[1][y] + gap[2][z];
    if (d >= search.reach_squared) continue;
    const Cell child = {level, {at[0][x], at[1][y], at[2][z]}};
    if (child.at[0] >= size[0] || child.at[1] >= size[1] || child.at[2] >= size[2]) continue;
    if (!(states(child) & search.wanted)) continue;
    if (level == 0) {
      search.reach_squared = d;
    } else {
      search.stack[search.waiting++] = {child, d};
    }
  }
}

/// Starts at the level where no more than two cells along each axis come within reach.
void VoxelDistance::push_cells_in_reach(Search& search) const {
  const double reach = std::sqrt(search.reach_squared);
  std::size_t level = 0;
  while (level < levels_.size() && static_cast<double>(std::int64_t{1} << level) * smallest_spacing_ < 2 * reach) {
    ++level;
  }
  const double width = static_cast<double>(std::int64_t{1} << level);
  const auto& size = size_of(level);
  std::array<std::int64_t, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto cell_at = [&](double x) {
      const double last = static_cast<double>(size[a]) - 1;
      return static_cast<std::int64_t>(std::clamp(std::floor((x / spacing_[a] + 0.5) / width), 0.0, last));
    };
    low[a] = cell_at(search.p[a] - reach);
    high[a] = cell_at(search.p[a] + reach);
  }
  for (std::int64_t k = low[2]; k <= high[2]; ++k) {
    for (std::int64_t j = low[1]; j <= high[1]; ++j) {
      for (std::int64_t i = low[0]; i <= high[0]; ++i) {
        const Cell cell = {level, {i, j, k}};
        const double d = box_distance_squared(cell, search.p);
        if (d < search.reach_squared && (states(cell) & search.wanted)) search.stack[search.waiting++] = {cell, d};
      }
    }
  }
}

}  // namespace anatomesh::assess_detail
