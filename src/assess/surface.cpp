#include "assess/surface.h"

#include <utility>

namespace anatomesh::assess_detail {

std::vector<Triangle> surface_of(std::span<const TetId> tets, Scope scope, const TissueMesh& mesh,
                                 const std::vector<TetMeasures>& measures, const Neighbours& neighbours) {
  std::vector<Triangle> surface;
  for (const TetId t : tets) {
    for (std::size_t k = 0; k < 4; ++k) {
      const TetId u = neighbours.across[t][k];
      const bool border =
          u == kOutside || (scope == Scope::tissue && u != kCrowded && mesh.tissue_of[u] != mesh.tissue_of[t]);
      if (!border) continue;
      const auto& f = kFaceOfTet[k];
      Triangle triangle = {mesh.tets[t][f[0]], mesh.tets[t][f[1]], mesh.tets[t][f[2]]};
      if (measures[t].volume_mm3 < 0) std::swap(triangle[1], triangle[2]);
      surface.push_back(triangle);
    }
  }
  return surface;
}

}  // namespace anatomesh::assess_detail
