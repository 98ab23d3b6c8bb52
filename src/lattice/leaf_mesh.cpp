#include "lattice/leaf_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/vec.h"
#include "lattice/lattice_point_map.h"

namespace anatomesh {
namespace {

// Nodes 0 .. 9 of a leaf (vertices, edge midpoints), in units of the finest level.
std::array<LatticePoint, 10> nodes_of(const RedGreenLattice& lattice, TetRef leaf) {
  const LatticePoint b = lattice.barycentre(leaf);
  std::array<LatticePoint, 10> nodes;
  const auto vertices = bcc_vertices(b);
  std::copy(vertices.begin(), vertices.end(), nodes.begin());
  for (int e = 0; e < 6; ++e) nodes[static_cast<std::size_t>(4 + e)] = bcc_edge_midpoint(b, e);
  for (LatticePoint& node : nodes) {
    for (std::int32_t& c : node) c *= 1 << (lattice.max_level() - leaf.level);
  }
  return nodes;
}

}  // namespace

LeafMesh mesh_of_leaves(const RedGreenLattice& lattice, const VoxelVotes& votes,
                        const std::vector<LabelledLeaf>& leaves, Vec3 origin_mm, double unit_mm) {
  LeafMesh result;
  LatticePointMap vertices;
  const auto is_bulk = [&](const LabelledLeaf& leaf) {
    return leaf.votes[0].tissue == 0 && !leaf.decided && votes.hands_label_down(leaf.tet);
  };
  for (const bool bulk : {false, true}) {
    const std::size_t near = vertices.points().size();
    for (std::uint32_t i = 0; i < leaves.size(); ++i) {
      const LabelledLeaf& leaf = leaves[i];
      if (is_bulk(leaf) != bulk) continue;
      const auto nodes = nodes_of(lattice, leaf.tet);
      if (bulk && std::none_of(nodes.begin(), nodes.end(), [&](auto& node) { return vertices.find(node) < near; }))
        continue;
      const bool positive = is_positive(lattice.barycentre(leaf.tet));
      for (std::uint32_t part = 0; part < static_cast<std::uint32_t>(leaf.split().count); ++part) {
        std::array<VertexId, 4> tet;
        for (std::size_t n = 0; n < 4; ++n) tet[n] = vertices.insert(nodes[leaf.split().tets[part][n]]);
        if (!positive) std::swap(tet[2], tet[3]);
        result.mesh.tets.push_back(tet);
        result.mesh.tissues.push_back(leaf.votes[part].tissue);
        result.origins.push_back({i, part});
      }
    }
  }
  result.points = vertices.points();
  const double fine_unit = std::ldexp(unit_mm, -lattice.max_level());
  for (const LatticePoint& p : result.points)
    result.mesh.points_mm.push_back(origin_mm + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]});
  return result;
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
