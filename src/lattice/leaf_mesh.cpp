#include "lattice/leaf_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/vec.h"

namespace anatomesh {
namespace {

// Nodes 0 .. 9 of a leaf (vertices, and midpoints of split edges; the first vertex for others), in units of the finest
// level.
std::array<LatticePoint, 10> nodes_of(const RedGreenLattice& lattice, TetRef leaf, unsigned split_edges) {
  const LatticePoint b = lattice.barycentre(leaf);
  std::array<LatticePoint, 10> nodes;
  const auto vertices = bcc_vertices(b);
  nodes.fill(vertices[0]);
  std::copy(vertices.begin(), vertices.end(), nodes.begin());
  for (int e = 0; e < 6; ++e) {
    if (split_edges >> e & 1) nodes[static_cast<std::size_t>(4 + e)] = bcc_edge_midpoint(b, e);
  }
  for (LatticePoint& node : nodes) {
    for (std::int32_t& c : node) c *= 1 << (lattice.max_level() - leaf.level);
  }
  return nodes;
}

}  // namespace

LeafMesh LeafMesher::mesh(const std::vector<LabelledLeaf>& leaves) {
  places_.resize(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; level <= lattice_.max_level(); ++level)
    places_[static_cast<std::size_t>(level)].resize(lattice_.slot_count(level));
  const Tets old = std::move(tets_);
  LeafMesh result;
  Tets& tets = result.mesh.tets;
  for (const bool bulk : {false, true}) {
    for (std::uint32_t i = 0; i < leaves.size(); ++i) {
      const LabelledLeaf& leaf = leaves[i];
      const bool is_bulk = leaf.votes[0].tissue == 0 && !leaf.decided && votes_.hands_label_down(leaf.tet);
      if (is_bulk != bulk) continue;
      const std::size_t first = tets.size();
      add(leaf, bulk, old, tets);
      for (std::uint32_t part = 0; part < tets.size() - first; ++part) {
        result.mesh.tissues.push_back(leaf.votes[part].tissue);
        result.origins.push_back({i, part});
      }
    }
  }
  tets_ = tets;
  result.points = vertices_.points();
  const double fine_unit = std::ldexp(unit_mm_, -lattice_.max_level());
  for (const LatticePoint& p : result.points)
    result.mesh.points_mm.push_back(origin_mm_ + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]});
  return result;
}

// Its tetrahedra; of bulk background only where it touches something else.
void LeafMesher::add(const LabelledLeaf& leaf, bool bulk, const Tets& old, Tets& tets) {
  Place& place = places_[static_cast<std::size_t>(leaf.tet.level)][leaf.tet.slot];
  const auto parts = static_cast<std::size_t>(leaf.split().count), first = tets.size();
  if (place.first_tet != Place{}.first_tet && place.split_edges == leaf.split_edges) {
    tets.insert(tets.end(), old.begin() + place.first_tet,
                old.begin() + place.first_tet + static_cast<std::ptrdiff_t>(parts));
  } else {
    const auto nodes = nodes_of(lattice_, leaf.tet, leaf.split_edges);
    if (bulk && !touches_near(nodes)) return;
    const bool positive = is_positive(lattice_.barycentre(leaf.tet));
    for (std::size_t part = 0; part < parts; ++part) {
      std::array<VertexId, 4> tet;
      for (std::size_t n = 0; n < 4; ++n) tet[n] = vertices_.insert(nodes[leaf.split().tets[part][n]]);
      if (!positive) std::swap(tet[2], tet[3]);
      tets.push_back(tet);
    }
  }
  place = {static_cast<std::uint32_t>(first), leaf.split_edges};
  near_.resize(vertices_.points().size());
  for (std::size_t t = first; !bulk && t < tets.size(); ++t) {
    for (const VertexId v : tets[t]) near_[v] = 1;
  }
}

bool LeafMesher::touches_near(const std::array<LatticePoint, 10>& nodes) const {
  return std::any_of(nodes.begin(), nodes.end(), [&](const LatticePoint& node) {
    const std::uint32_t v = vertices_.find(node);
    return v != LatticePointMap::kNone && near_[v];
  });
}

TissueMesh with_cushion_only(TissueMesh mesh) {
  std::vector<char> on_tissue(mesh.points_mm.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.tissues[t] == 0) continue;
    for (const VertexId v : mesh.tets[t]) on_tissue[v] = 1;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    if (std::none_of(tet.begin(), tet.end(), [&](VertexId v) { return on_tissue[v]; })) continue;
    mesh.tets[kept] = tet;
    mesh.tissues[kept++] = mesh.tissues[t];
  }
  mesh.tets.resize(kept);
  mesh.tissues.resize(kept);
  return with_cushion_last(mesh);
}

}  // namespace anatomesh
