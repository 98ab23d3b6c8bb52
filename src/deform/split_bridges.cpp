#include "deform/split_bridges.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "mesh/adjacency.h"

namespace anatomesh {
namespace {

constexpr int kRounds = 6;

struct Bridge {
  double length2;
  VertexId low, high;
  bool operator<(const Bridge& b) const {
    return length2 != b.length2 ? length2 > b.length2 : low != b.low ? low < b.low : high < b.high;
  }
  bool operator==(const Bridge&) const = default;
};

// The mesh with what is needed to find its bridges.
struct Neighbourhood {
  VertexLists<TetId> tets_of_vertex;
  VertexLists<TissueId> tissues_of_vertex;

  explicit Neighbourhood(const TissueMesh& mesh)
      : tets_of_vertex(tets_of_vertices(mesh.points_mm.size(), mesh.tets)),
        tissues_of_vertex(tissues_of_vertices(tets_of_vertex, mesh.tissues)) {}

  bool on_interface(VertexId v) const { return tissues_of_vertex[v].size() > 1; }
};

// Of the mesh as it was at the start of the round.
std::vector<TetId> tets_around(const Neighbourhood& near, VertexId a, VertexId b) {
  std::vector<TetId> ring;
  std::ranges::set_intersection(near.tets_of_vertex[a], near.tets_of_vertex[b], std::back_inserter(ring));
  return ring;
}

void append_bridges(const TissueMesh& mesh, const Neighbourhood& near, TetId t, std::vector<Bridge>& bridges) {
  const auto& tet = mesh.tets[t];
  if (mesh.tissues[t] == 0) return;
  if (!std::ranges::all_of(tet, [&](VertexId v) { return near.on_interface(v); })) return;
  for (const auto& [i, j] : kEdgeCorners) {
    const VertexId a = std::min(tet[i], tet[j]), b = std::max(tet[i], tet[j]);
    if (std::ranges::all_of(tets_around(near, a, b), [&](TetId r) { return mesh.tissues[r] == mesh.tissues[t]; }))
      bridges.push_back({norm_squared(mesh.points_mm[a] - mesh.points_mm[b]), a, b});
  }
}

// Edges of tetrahedra that have all their vertices on interfaces, and around which there is one tissue only.
std::vector<Bridge> find_bridges(const TissueMesh& mesh, const Neighbourhood& near) {
  constexpr std::size_t kGrain = 1 << 14;
  std::vector<std::vector<Bridge>> blocks(mesh.tets.size() / kGrain + 1);
  parallel_blocks(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) append_bridges(mesh, near, static_cast<TetId>(t), blocks[begin / kGrain]);
  });
  std::vector<Bridge> bridges;
  for (const auto& block : blocks) bridges.insert(bridges.end(), block.begin(), block.end());
  sort_and_unify(bridges);
  return bridges;
}

std::array<VertexId, 4> replaced(std::array<VertexId, 4> tet, VertexId from, VertexId to) {
  std::replace(tet.begin(), tet.end(), from, to);
  return tet;
}

bool halves_fit(const TissueMesh& mesh, TetId t, const Bridge& edge, Vec3 middle, const ShapeBounds& bounds) {
  for (const VertexId end : {edge.low, edge.high}) {
    std::array<Vec3, 4> p;
    for (std::size_t n = 0; n < 4; ++n) p[n] = mesh.tets[t][n] == end ? middle : mesh.points_mm[mesh.tets[t][n]];
    if (!within(bounds, p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

void split(TissueMesh& mesh, const Bridge& edge, const std::vector<TetId>& ring, Vec3 middle) {
  const auto m = static_cast<VertexId>(mesh.points_mm.size());
  mesh.points_mm.push_back(middle);
  for (const TetId t : ring) {
    const std::array<VertexId, 4> tet = mesh.tets[t];
    mesh.tets[t] = replaced(tet, edge.low, m);
    mesh.tets.push_back(replaced(tet, edge.high, m));
    mesh.tissues.push_back(mesh.tissues[t]);
  }
}

}  // namespace

ShapeBounds well_shaped(const ShapeBounds& asked) {
  const ShapeBounds well = ShapeBounds::from_degrees(25, 135, 0.4);
  return {std::min(well.largest_cos, asked.largest_cos), std::max(well.smallest_cos, asked.smallest_cos),
          std::max(well.min_mean_ratio, asked.min_mean_ratio)};
}

void split_bridges(TissueMesh& mesh, const ShapeBounds& asked, const Stage& stage) {
  const ShapeBounds bounds = well_shaped(asked);
  for (int round = 0; round < kRounds; ++round) {
    stage.check_cancelled();
    const Neighbourhood near(mesh);
    std::vector<char> touched(mesh.tets.size());
    bool changed = false;
    for (const Bridge& edge : find_bridges(mesh, near)) {
      const std::vector<TetId> ring = tets_around(near, edge.low, edge.high);
      const Vec3 middle = 0.5 * (mesh.points_mm[edge.low] + mesh.points_mm[edge.high]);
      if (!std::ranges::all_of(ring, [&](TetId t) { return !touched[t] && halves_fit(mesh, t, edge, middle, bounds); }))
        continue;
      for (const TetId t : ring) touched[t] = 1;
      split(mesh, edge, ring, middle);
      changed = true;
    }
    if (!changed) break;
  }
  mesh = in_spatial_order(mesh);
}

}  // namespace anatomesh
