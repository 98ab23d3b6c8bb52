#include "lattice/root_voxels.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "base/parallel.h"
#include "lattice/bcc_lattice.h"

namespace anatomesh {
namespace {

// Where a point of a lattice cube lies is a matter of which coordinate is farthest from the cube's centre, which next,
// and on which sides: six bits, and a table of what bcc_locate says.
struct Home {
  LatticePoint cell;  // relative to the point's: 0 or 1
  std::int32_t local;
};

// x_beyond_y: |x| >= |y|, and so on.
unsigned code_of(bool x_beyond_y, bool x_beyond_z, bool y_beyond_z, unsigned negative) {
  return unsigned{x_beyond_y} | unsigned{x_beyond_z} << 1u | unsigned{y_beyond_z} << 2u | negative << 3u;
}

std::array<Home, 64> make_homes() {
  std::array<Home, 64> homes;
  for (unsigned code = 0; code < 64; ++code) {
    const bool xy = code & 1u, xz = code & 2u, yz = code & 4u;
    const std::array<int, 3> rank = {int{xy} + int{xz}, int{!xy} + int{yz}, int{!xz} + int{!yz}};
    Vec3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      const double distance = 0.5 * (1 + rank[a]);
      point[a] = 2 + (code >> (3 + a) & 1u ? -distance : distance);
    }
    const LatticePoint b = bcc_locate(point);
    homes[code] = {bcc_cell(b), bcc_local_index(b)};
  }
  return homes;
}

class RootSorter {
 public:
  RootSorter(const std::array<std::vector<double>, 3>& position, const std::array<std::int32_t, 3>& root_cells)
      : cells_(root_cells), homes_(make_homes()) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (const double x : position[a]) {
        const auto cell = static_cast<std::int32_t>(std::floor(x / 4));
        const double off = x - (4 * cell + 2);
        axes_[a].push_back({std::abs(off), cell, off < 0});
      }
    }
    const auto is_inner = [&](const Coordinate& x) { return is_inner_cell(0, x.cell); };
    first_inner_ = static_cast<std::size_t>(std::ranges::find_if(axes_[0], is_inner) - axes_[0].begin());
    end_inner_ = first_inner_;
    while (end_inner_ < axes_[0].size() && is_inner(axes_[0][end_inner_])) ++end_inner_;
    for (std::size_t k = 0; k < axes_[2].size(); ++k) {
      if (k == 0 || axes_[2][k].cell != axes_[2][k - 1].cell) layers_.push_back(k);
    }
    layers_.push_back(axes_[2].size());
  }

  // A tetrahedron has voxels of its own layer of cubes and of the one below, so the lists have two parts, each of which
  // one layer fills.
  RootVoxels run() const {
    const auto slots = static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                       static_cast<std::size_t>(cells_[2]) * kTetsPerCell;
    std::array<std::vector<std::uint32_t>, 2> next = {std::vector<std::uint32_t>(slots),
                                                      std::vector<std::uint32_t>(slots)};
    for_each_voxel([&](std::size_t below, std::size_t slot, std::uint32_t) { ++next[below][slot]; });
    RootVoxels sorted;
    sorted.begin.resize(slots + 1);
    std::uint32_t count = 0;
    for (std::size_t s = 0; s < slots; ++s) {
      sorted.begin[s] = count;
      const std::uint32_t from_below = std::exchange(next[1][s], count);
      count += from_below;
      count += std::exchange(next[0][s], count);
    }
    sorted.begin[slots] = count;
    sorted.order.resize(count);
    for_each_voxel(
        [&](std::size_t below, std::size_t slot, std::uint32_t voxel) { sorted.order[next[below][slot]++] = voxel; });
    return sorted;
  }

 private:
  struct Coordinate {
    double far;  // from the cell's centre
    std::int32_t cell;
    bool negative;
  };

  bool is_inner_cell(std::size_t axis, std::int32_t cell) const { return cell >= 0 && cell + 1 < cells_[axis]; }

  template <class Visit>
  void for_each_voxel(const Visit& visit) const {
    parallel_for(
        layers_.size() - 1,
        [&](std::size_t layer) {
          for (std::size_t k = layers_[layer]; k < layers_[layer + 1]; ++k) {
            for (std::size_t j = 0; j < axes_[1].size(); ++j) visit_row(j, k, visit);
          }
        },
        1);
  }

  // Calls visit(1 for a voxel of the layer below its tetrahedron's, else 0; slot; voxel).
  template <class Visit>
  void visit_row(std::size_t j, std::size_t k, const Visit& visit) const {
    const Coordinate y = axes_[1][j], z = axes_[2][k];
    const bool inner = is_inner_cell(1, y.cell) && is_inner_cell(2, z.cell);
    const std::int64_t first = std::int64_t{kTetsPerCell} * cells_[0] * (y.cell + cells_[1] * z.cell);
    // In a row, only three bits of the code vary.
    std::array<Home, 8> homes;
    std::array<std::int64_t, 8> slots;
    for (unsigned n = 0; n < 8; ++n) {
      const unsigned negative = unsigned{y.negative} << 1u | unsigned{z.negative} << 2u | n >> 2u;
      homes[n] = homes_[code_of(n & 1u, n & 2u, y.far >= z.far, negative)];
      const auto& [cell, local] = homes[n];
      slots[n] = first + kTetsPerCell * (cell[0] + cells_[0] * (cell[1] + std::int64_t{cells_[1]} * cell[2])) + local;
    }
    const auto first_voxel = static_cast<std::uint32_t>(axes_[0].size() * (j + axes_[1].size() * k));
    const auto visit_voxels = [&](std::size_t begin, std::size_t end, const auto& may_be_outside) {
      for (std::size_t i = begin; i < end; ++i) {
        const Coordinate& x = axes_[0][i];
        const unsigned n = unsigned{x.far >= y.far} | unsigned{x.far >= z.far} << 1u | unsigned{x.negative} << 2u;
        const LatticePoint& cell = homes[n].cell;
        if (may_be_outside && !is_in_lattice({x.cell + cell[0], y.cell + cell[1], z.cell + cell[2]})) continue;
        visit(static_cast<std::size_t>(cell[2]), static_cast<std::size_t>(slots[n] + kTetsPerCell * x.cell),
              first_voxel + static_cast<std::uint32_t>(i));
      }
    };
    constexpr std::true_type kMayBeOutside;
    constexpr std::false_type kIsInside;
    if (!inner) return visit_voxels(0, axes_[0].size(), kMayBeOutside);
    visit_voxels(0, first_inner_, kMayBeOutside);
    visit_voxels(first_inner_, end_inner_, kIsInside);
    visit_voxels(end_inner_, axes_[0].size(), kMayBeOutside);
  }

  bool is_in_lattice(const LatticePoint& cell) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (cell[a] < 0 || cell[a] >= cells_[a]) return false;
    }
    return true;
  }

  std::array<std::int32_t, 3> cells_;
  std::array<Home, 64> homes_;  // by code
  std::array<std::vector<Coordinate>, 3> axes_;
  std::size_t first_inner_ = 0, end_inner_ = 0;  // along the first axis: voxels whose tetrahedra are all in the lattice
  std::vector<std::size_t> layers_;  // along the last axis: first voxels of the layers of cubes, and the end
};

}  // namespace

RootVoxels sort_into_roots(const std::array<std::vector<double>, 3>& position,
                           const std::array<std::int32_t, 3>& root_cells) {
  return RootSorter(position, root_cells).run();
}

}  // namespace anatomesh
