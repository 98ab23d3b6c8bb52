#include "assess/rasterise.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "anatomesh/errors.h"
#include "assess/tet_measures.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

constexpr std::int64_t kSlabSlices = 4;

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
  VoxelRange range;  ///< voxels whose centres its bounding box holds

  /// False when it holds no voxel centre.
  bool set(const std::array<Vec3, 4>& p, const LabelImage& image);
};

VoxelRange bounding_range(const std::array<Vec3, 4>& p, const LabelImage& image) {
  VoxelRange range;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax({p[0][a], p[1][a], p[2][a], p[3][a]});
    std::tie(range.low[a], range.high[a]) = voxels_between(low, high, image.size[a]);
  }
  return range;
}

bool Tet::set(const std::array<Vec3, 4>& p, const LabelImage& image) {
  range = bounding_range(p, image);
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

/// A few slices of the image, and who holds their voxel centres.
class Slab {
 public:
  Slab(const LabelImage& image, std::int64_t first_slice)
      : image_(image),
        first_(first_slice),
        end_(std::min(first_slice + kSlabSlices, static_cast<std::int64_t>(image.size[2]))),
        owner_(image.size[0] * image.size[1] * static_cast<std::size_t>(end_ - first_), 0),
        holders_(owner_.size(), 0) {}

  void enter(const Tet& tet, Tissue tissue) {
    for (std::int64_t k = std::max(first_, tet.range.low[2]); k <= std::min(end_ - 1, tet.range.high[2]); ++k) {
      for (std::int64_t j = tet.range.low[1]; j <= tet.range.high[1]; ++j) enter_row(tet, tissue, j, k);
    }
  }

  /// Compares with the image.
  Coverage count(const std::vector<Label>& labels) const;

 private:
  void enter_row(const Tet& tet, Tissue tissue, std::int64_t j, std::int64_t k);

  const LabelImage& image_;
  std::int64_t first_, end_;           // slices
  std::vector<std::uint32_t> owner_;   // tissue + 1, or 0
  std::vector<std::uint8_t> holders_;  // tetrahedra that hold the centre strictly; 2 stands for more as well
};

void Slab::enter_row(const Tet& tet, Tissue tissue, std::int64_t j, std::int64_t k) {
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
  const auto [begin, last] = voxels_between(low, high, image_.size[0]);
  const std::size_t row =
      image_.size[0] * (static_cast<std::size_t>(j) + image_.size[1] * static_cast<std::size_t>(k - first_));
  for (std::int64_t i = begin; i <= last; ++i) {
    const auto x = static_cast<double>(i);
    const double smallest = std::min(std::min(at_0[0] + tet.gradient[0].x * x, at_0[1] + tet.gradient[1].x * x),
                                     std::min(at_0[2] + tet.gradient[2].x * x, at_0[3] + tet.gradient[3].x * x));
    const std::size_t voxel = row + static_cast<std::size_t>(i);
    if (smallest > kStrictlyInside) {
      if (holders_[voxel] == 0) owner_[voxel] = tissue + 1;
      if (holders_[voxel] < 2) ++holders_[voxel];
    } else if (owner_[voxel] == 0) {
      owner_[voxel] = tissue + 1;
    }
  }
}

Coverage Slab::count(const std::vector<Label>& labels) const {
  Coverage c;
  c.tissues.resize(labels.size());
  LabelLookup tissue_of(labels);
  const std::size_t nx = image_.size[0], ny = image_.size[1];
  const Label* voxels = image_.voxels.data() + nx * ny * static_cast<std::size_t>(first_);
  std::size_t v = 0;
  for (std::int64_t k = first_; k < end_; ++k) {
    for (std::int64_t j = 0; j < static_cast<std::int64_t>(ny); ++j) {
      for (std::int64_t i = 0; i < static_cast<std::int64_t>(nx); ++i, ++v) {
        const std::uint32_t owner = owner_[v];
        c.in_several += holders_[v] > 1;
        if (owner != 0) ++c.tissues[owner - 1].mesh;
        if (voxels[v] == 0) continue;
        const Tissue t = tissue_of(voxels[v]);
        VoxelCounts& counts = c.tissues[t];
        ++counts.image;
        counts.common += owner == t + 1;
        c.whole.common += owner != 0;
        counts.range.include({{i, j, k}, {i, j, k}});
      }
    }
  }
  return c;
}

void add(Coverage& to, const Coverage& from) {
  for (std::size_t t = 0; t < to.tissues.size(); ++t) {
    to.tissues[t].image += from.tissues[t].image;
    to.tissues[t].mesh += from.tissues[t].mesh;
    to.tissues[t].common += from.tissues[t].common;
    to.tissues[t].range.include(from.tissues[t].range);
  }
  to.whole.common += from.whole.common;
  to.in_several += from.in_several;
}

/// The tetrahedra that reach each slab, in the order of the mesh.
std::vector<std::vector<TetId>> sort_into_slabs(const TissueMesh& mesh, const std::vector<Vec3>& points_vox,
                                                const LabelImage& image) {
  std::vector<std::vector<TetId>> slabs((image.size[2] + kSlabSlices - 1) / kSlabSlices);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    const auto [low, high] =
        std::minmax({points_vox[tet[0]].z, points_vox[tet[1]].z, points_vox[tet[2]].z, points_vox[tet[3]].z});
    const auto [first, last] = voxels_between(low, high, image.size[2]);
    if (last < first) continue;
    for (std::int64_t s = first / kSlabSlices; s <= last / kSlabSlices; ++s) {
      slabs[static_cast<std::size_t>(s)].push_back(t);
    }
  }
  return slabs;
}

}  // namespace

void VoxelRange::include(const VoxelRange& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

Coverage rasterise(const TissueMesh& mesh, const std::vector<Vec3>& points_vox, const LabelImage& image,
                   const std::stop_token& cancel) {
  const auto slabs = sort_into_slabs(mesh, points_vox, image);
  std::vector<Coverage> parts(slabs.size());
  parallel_for(
      slabs.size(),
      [&](std::size_t s) {
        if (cancel.stop_requested()) throw Cancelled();
        Slab slab(image, static_cast<std::int64_t>(s) * kSlabSlices);
        Tet tet;
        for (const TetId t : slabs[s]) {
          std::array<Vec3, 4> corners;
          for (std::size_t k = 0; k < 4; ++k) corners[k] = points_vox[mesh.tets[t][k]];
          if (tet.set(corners, image)) slab.enter(tet, mesh.tissue_of[t]);
        }
        parts[s] = slab.count(mesh.labels);
      },
      1);
  Coverage sum;
  sum.tissues.resize(mesh.tissue_count());
  for (const Coverage& part : parts) add(sum, part);
  for (const VoxelCounts& t : sum.tissues) {
    sum.whole.image += t.image;
    sum.whole.mesh += t.mesh;
    sum.whole.range.include(t.range);
    sum.right += t.common;
  }
  return sum;
}

}  // namespace anatomesh::assess_detail
