#include "mesh/voxel_owners.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

constexpr std::int64_t kSlabSlices = OwnedSlices::kMost;

// Corners of the face opposite to each vertex.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaceOfTet = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Voxels low to high (inclusive) along each axis.
struct VoxelBox {
  std::array<std::int64_t, 3> low, high;
};

// Barycentric coordinates: above the one a centre is strictly inside, above the other it touches. Lattice planes often
// pass exactly through voxel centres.
constexpr double kStrictlyInside = 1e-6;
constexpr double kTouching = -1e-9;

/// The whole numbers in [low - 1e-9, high + 1e-9], cut to [0, size).
std::pair<std::int64_t, std::int64_t> voxels_between(double low, double high, std::size_t size) {
  const double last = static_cast<double>(size) - 1;
  return {static_cast<std::int64_t>(std::ceil(std::clamp(low - 1e-9, 0.0, last + 1))),
          static_cast<std::int64_t>(std::floor(std::clamp(high + 1e-9, -1.0, last)))};
}

/// A tetrahedron as its four barycentric coordinates, each an affine function of the voxel index.
struct Tet {
  std::array<Vec3, 4> gradient;
  std::array<double, 4> constant;
  VoxelBox range;  ///< voxels whose centres its bounding box holds

  /// False when it holds no voxel centre.
  bool set(const std::array<Vec3, 4>& p, const GridSize& size);
};

VoxelBox bounding_range(const std::array<Vec3, 4>& p, const GridSize& size) {
  VoxelBox range;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax({p[0][a], p[1][a], p[2][a], p[3][a]});
    std::tie(range.low[a], range.high[a]) = voxels_between(low, high, size[a]);
  }
  return range;
}

bool Tet::set(const std::array<Vec3, 4>& p, const GridSize& size) {
  range = bounding_range(p, size);
  for (std::size_t a = 0; a < 3; ++a) {
    if (range.high[a] < range.low[a]) return false;
  }
  if (dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) == 0) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& f = kFaceOfTet[k];
    const Vec3 normal = cross(p[f[1]] - p[f[0]], p[f[2]] - p[f[0]]);
    gradient[k] = 1 / dot(normal, p[k] - p[f[0]]) * normal;
    constant[k] = -dot(gradient[k], p[f[0]]);
  }
  return true;
}

/// A few slices of the grid while their centres are given away.
class Slab {
 public:
  Slab(const GridSize& size, std::int64_t first_slice)
      : size_(size),
        first_(first_slice),
        end_(std::min(first_slice + kSlabSlices, static_cast<std::int64_t>(size[2]))),
        owner_(size[0] * size[1] * static_cast<std::size_t>(end_ - first_), kNoTet),
        holders_(owner_.size(), 0) {}

  void enter(const Tet& tet, TetId t) {
    for (std::int64_t k = std::max(first_, tet.range.low[2]); k <= std::min(end_ - 1, tet.range.high[2]); ++k) {
      for (std::int64_t j = tet.range.low[1]; j <= tet.range.high[1]; ++j) enter_row(tet, t, j, k);
    }
  }

  OwnedSlices slices() const { return {static_cast<std::size_t>(first_), owner_, holders_}; }

 private:
  void enter_row(const Tet& tet, TetId t, std::int64_t j, std::int64_t k);

  const GridSize& size_;
  std::int64_t first_, end_;  // slices
  std::vector<TetId> owner_;
  std::vector<std::uint8_t> holders_;  // tetrahedra that hold the centre strictly; 2 stands for more as well
};

void Slab::enter_row(const Tet& tet, TetId t, std::int64_t j, std::int64_t k) {
  // Along the row each barycentric coordinate is linear in i: cut the row to where none is negative.
  std::array<double, 4> at_0;
  auto low = static_cast<double>(tet.range.low[0]), high = static_cast<double>(tet.range.high[0]);
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3& g = tet.gradient[c];
    at_0[c] = tet.constant[c] + g.y * static_cast<double>(j) + g.z * static_cast<double>(k);
    if (std::abs(g.x) <= 1e-14) {
      if (at_0[c] < kTouching) return;
      continue;
    }
    const double zero = (kTouching - at_0[c]) / g.x;
    if (g.x > 0) {
      low = std::max(low, zero);
    } else {
      high = std::min(high, zero);
    }
  }
  const auto [begin, last] = voxels_between(low, high, size_[0]);
  const std::size_t row = size_[0] * (static_cast<std::size_t>(j) + size_[1] * static_cast<std::size_t>(k - first_));
  for (std::int64_t i = begin; i <= last; ++i) {
    const auto x = static_cast<double>(i);
    const double smallest = std::min(std::min(at_0[0] + tet.gradient[0].x * x, at_0[1] + tet.gradient[1].x * x),
                                     std::min(at_0[2] + tet.gradient[2].x * x, at_0[3] + tet.gradient[3].x * x));
    const std::size_t voxel = row + static_cast<std::size_t>(i);
    if (smallest > kStrictlyInside) {
      if (holders_[voxel] == 0) owner_[voxel] = t;
      if (holders_[voxel] < 2) ++holders_[voxel];
    } else if (owner_[voxel] == kNoTet) {
      owner_[voxel] = t;
    }
  }
}

/// The tetrahedra that reach each slab, in the order of the mesh.
std::vector<std::vector<TetId>> sort_into_slabs(std::span<const Vec3> points_vox,
                                                std::span<const std::array<VertexId, 4>> tets, const GridSize& size) {
  std::vector<std::vector<TetId>> slabs((size[2] + kSlabSlices - 1) / kSlabSlices);
  for (TetId t = 0; t < tets.size(); ++t) {
    const auto& tet = tets[t];
    const auto [low, high] =
        std::minmax({points_vox[tet[0]].z, points_vox[tet[1]].z, points_vox[tet[2]].z, points_vox[tet[3]].z});
    const auto [first, last] = voxels_between(low, high, size[2]);
    if (last < first) continue;
    for (std::int64_t s = first / kSlabSlices; s <= last / kSlabSlices; ++s)
      slabs[static_cast<std::size_t>(s)].push_back(t);
  }
  return slabs;
}

}  // namespace

void for_each_owned_slices(std::span<const Vec3> points_vox, std::span<const std::array<VertexId, 4>> tets,
                           const GridSize& size, const std::stop_token& cancel,
                           const std::function<void(const OwnedSlices&)>& visit) {
  const auto slabs = sort_into_slabs(points_vox, tets, size);
  parallel_for(
      slabs.size(),
      [&](std::size_t s) {
        if (cancel.stop_requested()) throw Cancelled();
        Slab slab(size, static_cast<std::int64_t>(s) * kSlabSlices);
        Tet tet;
        for (const TetId t : slabs[s]) {
          std::array<Vec3, 4> corners;
          for (std::size_t k = 0; k < 4; ++k) corners[k] = points_vox[tets[t][k]];
          if (tet.set(corners, size)) slab.enter(tet, t);
        }
        visit(slab.slices());
      },
      1);
}

}  // namespace anatomesh
