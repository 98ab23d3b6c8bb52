#include "mesh/tissue_mesh.h"

#include <algorithm>

namespace anatomesh {

std::size_t tissue_tets(const TissueMesh& mesh) {
  return mesh.tissues.size() - static_cast<std::size_t>(std::ranges::count(mesh.tissues, TissueId{0}));
}

TissueMesh with_cushion_last(const TissueMesh& mesh) {
  constexpr auto kUnused = static_cast<VertexId>(-1);
  TissueMesh sorted;
  std::vector<VertexId> number(mesh.points_mm.size(), kUnused);
  for (const bool cushion : {false, true}) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
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

}  // namespace anatomesh
