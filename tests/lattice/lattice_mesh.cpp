#include "lattice/lattice_mesh.h"

#include <map>
#include <utility>

namespace anatomesh::testing {

std::vector<TetRef> leaves_of(const RedGreenLattice& lattice) {
  std::vector<TetRef> leaves;
  for (int level = 0; level <= lattice.max_level(); ++level) {
    for (const TetRef t : lattice.tets_of_level(level)) {
      if (lattice.is_leaf(t)) leaves.push_back(t);
    }
  }
  return leaves;
}

LatticeMesh mesh_of(const RedGreenLattice& lattice) {
  LatticeMesh mesh;
  std::map<LatticePoint, VertexId> numbers;
  const auto number = [&](LatticePoint p, int level) {
    for (auto& c : p) c *= 1 << (lattice.max_level() - level);
    const auto [at, fresh] = numbers.try_emplace(p, static_cast<VertexId>(mesh.points.size()));
    if (fresh) {
      mesh.points.push_back({static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    return at->second;
  };
  for (const TetRef leaf : leaves_of(lattice)) {
    const LatticePoint b = lattice.barycentre(leaf);
    const auto vertices = bcc_vertices(b);
    const unsigned mask = lattice.split_edges(leaf);
    const GreenSplit& split = green_split(mask);
    for (std::size_t c = 0; c < static_cast<std::size_t>(split.count); ++c) {
      Tet tet{};
      for (std::size_t n = 0; n < 4; ++n) {
        const int node = split.tets[c][n];
        tet[n] =
            number(node < 4 ? vertices[static_cast<std::size_t>(node)] : bcc_edge_midpoint(b, node - 4), leaf.level);
      }
      if (!is_positive(b)) std::swap(tet[2], tet[3]);
      mesh.tets.push_back(tet);
    }
  }
  return mesh;
}

}  // namespace anatomesh::testing
