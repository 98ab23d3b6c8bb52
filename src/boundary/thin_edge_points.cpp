// The non-connectivity patterns of F. Drakopoulos and N. Chrisochoides, "Tetrahedral Image-To-Mesh Conversion for
// Anatomical Modeling and Surgical Simulations", Table 2. The paper thins the edge points as one set; here each pair
// of tissues is thinned on its own, so that a surface does not lose its targets to another one beside it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <unordered_map>

#include "base/parallel.h"
#include "boundary/edge_points.h"

namespace anatomesh {
namespace {

using Voxel = std::array<int, 3>;

bool before(const Voxel& a, const Voxel& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); }

// Along how many axes two neighbouring voxels may differ and still count as touching.
int axes_of(NonConnectivity pattern) {
  switch (pattern) {
    case NonConnectivity::vertex:
      return 3;
    case NonConnectivity::edge:
      return 2;
    case NonConnectivity::face:
      return 1;
    case NonConnectivity::none:
      break;
  }
  return -1;
}

// Voxels taken so far, in ascending order, and a cursor into them for each row of voxels that can hold a neighbour
// of the next one. The voxels asked for ascend, so each cursor only moves forward.
class TakenVoxels {
 public:
  explicit TakenVoxels(int axes) : axes_(axes) {}

  bool touch(const Voxel& voxel) {
    bool found = false;
    for (Row& row : rows_) {
      const Voxel first = {voxel[0] - 1, voxel[1] + row.dj, voxel[2] + row.dk};
      while (row.cursor < taken_.size() && before(taken_[row.cursor], first)) ++row.cursor;
      for (std::size_t n = row.cursor; n < taken_.size() && touches_in_row(taken_[n], first); ++n)
        found = found || differing_axes(taken_[n], voxel) <= axes_;
    }
    return found;
  }

  void add(const Voxel& voxel) { taken_.push_back(voxel); }

 private:
  struct Row {
    int dj, dk;
    std::size_t cursor = 0;
  };

  static bool touches_in_row(const Voxel& voxel, const Voxel& first) {
    return voxel[2] == first[2] && voxel[1] == first[1] && voxel[0] <= first[0] + 2;
  }
  static int differing_axes(const Voxel& a, const Voxel& b) {
    return static_cast<int>(a[0] != b[0]) + static_cast<int>(a[1] != b[1]) + static_cast<int>(a[2] != b[2]);
  }

  int axes_;
  std::vector<Voxel> taken_;
  std::array<Row, 5> rows_ = {{{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {0, 0}}};
};

// Positions in `points` of each pair's points, in the order given.
std::vector<std::vector<std::size_t>> group_by_pair(std::span<const EdgePoint> points) {
  std::unordered_map<std::uint32_t, std::size_t> group_of;
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const std::uint32_t key = std::uint32_t{points[n].pair.low} << 16 | points[n].pair.high;
    const auto [at, is_new] = group_of.try_emplace(key, groups.size());
    if (is_new) groups.emplace_back();
    groups[at->second].push_back(n);
  }
  return groups;
}

void thin_group(std::span<const EdgePoint> points, std::vector<std::size_t>& group, int axes,
                std::vector<std::uint8_t>& keep) {
  const auto in_order = [&](std::size_t a, std::size_t b) { return before(points[a].voxel, points[b].voxel); };
  if (!std::is_sorted(group.begin(), group.end(), in_order)) std::stable_sort(group.begin(), group.end(), in_order);
  TakenVoxels taken(axes);
  for (const std::size_t n : group) {
    if (taken.touch(points[n].voxel)) continue;
    taken.add(points[n].voxel);
    keep[n] = 1;
  }
}

}  // namespace

std::vector<EdgePoint> thin_edge_points(std::span<const EdgePoint> points, NonConnectivity pattern) {
  if (pattern == NonConnectivity::none) return {points.begin(), points.end()};
  std::vector<std::vector<std::size_t>> groups = group_by_pair(points);
  std::vector<std::uint8_t> keep(points.size(), 0);
  parallel_for(
      groups.size(), [&](std::size_t g) { thin_group(points, groups[g], axes_of(pattern), keep); }, 1);
  std::vector<EdgePoint> kept;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (keep[n] != 0) kept.push_back(points[n]);
  }
  return kept;
}

}  // namespace anatomesh
