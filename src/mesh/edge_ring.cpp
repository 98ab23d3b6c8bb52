#include "mesh/edge_ring.h"

#include <algorithm>
#include <utility>

namespace anatomesh {
namespace {

// The other two corners x, y of a tetrahedron abxy in positive orientation.
std::array<VertexId, 2> opposite_edge(const std::array<VertexId, 4>& tet, VertexId a, VertexId b) {
  // Even permutations (i, j, k, l) of the corners, by i and j.
  constexpr std::array<std::array<std::array<std::uint8_t, 2>, 4>, 4> kOther = {{
      {{{0, 0}, {2, 3}, {3, 1}, {1, 2}}},
      {{{3, 2}, {0, 0}, {0, 3}, {2, 0}}},
      {{{1, 3}, {3, 0}, {0, 0}, {0, 1}}},
      {{{2, 1}, {0, 2}, {1, 0}, {0, 0}}},
  }};
  const auto i = static_cast<std::size_t>(std::ranges::find(tet, a) - tet.begin());
  const auto j = static_cast<std::size_t>(std::ranges::find(tet, b) - tet.begin());
  return {tet[kOther[i][j][0]], tet[kOther[i][j][1]]};
}

}  // namespace

bool find_ring(const MeshEditor& mesh, VertexId a, VertexId b, EdgeRing& ring) {
  ring.a = a;
  ring.b = b;
  ring.size = 0;
  std::array<VertexId, EdgeRing::kMax> next;
  for (const TetId t : mesh.tets_at(a)) {
    const auto& tet = mesh.tet(t);
    if (std::ranges::find(tet, b) == tet.end()) continue;
    if (ring.size == EdgeRing::kMax) return false;
    const auto [x, y] = opposite_edge(tet, a, b);
    ring.link[ring.size] = x;
    next[ring.size] = y;
    ring.tets[ring.size++] = t;
  }
  for (std::size_t n = 0; n + 1 < ring.size; ++n) {  // each tetrahedron starts where the one before ends
    std::size_t m = n + 1;
    while (m < ring.size && ring.link[m] != next[n]) ++m;
    if (m == ring.size) return false;
    std::swap(ring.link[m], ring.link[n + 1]);
    std::swap(ring.tets[m], ring.tets[n + 1]);
    std::swap(next[m], next[n + 1]);
  }
  return ring.size > 2 && next[ring.size - 1] == ring.link[0];
}

}  // namespace anatomesh
