#include "mesh/tissue_mesh.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

std::size_t tissue_tets(const TissueMesh& mesh) {
  return mesh.tissues.size() - static_cast<std::size_t>(std::ranges::count(mesh.tissues, TissueId{0}));
}

std::vector<double> tissue_volumes_mm3(const TissueMesh& mesh, std::size_t tissues) {
  std::vector<double> volume(tissues, 0);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    volume[mesh.tissues[t]] +=
        six_volumes(mesh.points_mm[a], mesh.points_mm[b], mesh.points_mm[c], mesh.points_mm[d]) / 6;
  }
  return volume;
}

namespace {

// The mesh with its tetrahedra in this order, the cushion's last.
TissueMesh reordered(const TissueMesh& mesh, std::span<const TetId> order) {
  constexpr auto kUnused = static_cast<VertexId>(-1);
  TissueMesh sorted;
  std::vector<VertexId> number(mesh.points_mm.size(), kUnused);
  for (const bool cushion : {false, true}) {
    for (const TetId t : order) {
      if ((mesh.tissues[t] == 0) != cushion) continue;
      std::array<VertexId, 4> tet = mesh.tets[t];
      for (VertexId& v : tet) {
        if (number[v] == kUnused) {
          number[v] = static_cast<VertexId>(sorted.points_mm.size());
          sorted.points_mm.push_back(mesh.points_mm[v]);
        }
        v = number[v];
      }
      sorted.tets.push_back(tet);
      sorted.tissues.push_back(mesh.tissues[t]);
    }
  }
  return sorted;
}

// The bits of a number of 21 bits, with two zeros after each.
std::uint64_t spread(std::uint64_t x) {
  x = (x | x << 32u) & 0x1f00000000ffffu;
  x = (x | x << 16u) & 0x1f0000ff0000ffu;
  x = (x | x << 8u) & 0x100f00f00f00f00fu;
  x = (x | x << 4u) & 0x10c30c30c30c30c3u;
  return (x | x << 2u) & 0x1249249249249249u;
}

}  // namespace

TissueMesh with_cushion_last(const TissueMesh& mesh) {
  std::vector<TetId> order(mesh.tets.size());
  std::iota(order.begin(), order.end(), TetId{0});
  return reordered(mesh, order);
}

TissueMesh in_spatial_order(const TissueMesh& mesh) {
  if (mesh.points_mm.empty()) return mesh;
  constexpr double kCells = 1 << 20;  // along an axis
  Vec3 low = mesh.points_mm.front(), high = low;
  for (const Vec3& p : mesh.points_mm) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  const Vec3 size = high - low;
  const double scale = kCells / std::max({size.x, size.y, size.z, 1e-300});
  std::vector<std::pair<std::uint64_t, TetId>> keys(mesh.tets.size());
  parallel_for(keys.size(), [&](std::size_t t) {
    Vec3 sum;
    for (const VertexId v : mesh.tets[t]) sum += mesh.points_mm[v];
    const Vec3 cell = scale * (0.25 * sum - low);
    keys[t] = {spread(static_cast<std::uint64_t>(cell.x)) | spread(static_cast<std::uint64_t>(cell.y)) << 1u |
                   spread(static_cast<std::uint64_t>(cell.z)) << 2u,
               static_cast<TetId>(t)};
  });
  std::ranges::sort(keys);
  std::vector<TetId> order(keys.size());
  std::ranges::transform(keys, order.begin(), [](const auto& key) { return key.second; });
  return reordered(mesh, order);
}

}  // namespace anatomesh
