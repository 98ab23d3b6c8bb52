#include "deform/sides.h"

#include <algorithm>
#include <array>

#include "base/vec.h"

namespace anatomesh {
namespace {

// More tissues at one point than this are all but unheard of; the first of them then speak for all.
constexpr std::size_t kMaxTissues = 8;

}  // namespace

// Sum over the tissues of (gradient of its share) . (direction from v into it). That direction is the sum of the area
// vectors of the faces opposite to v.
bool is_on_its_side(const TissueMesh& mesh, const MeshTopology& topology, const SurfaceField& field, VertexId v,
                    Vec3 p) {
  const auto tissues = topology.tissues_of_vertex[v].first(std::min(topology.tissues_of_vertex[v].size(), kMaxTissues));
  std::array<double, kMaxTissues> share;
  std::array<Vec3, kMaxTissues> gradient;
  field.evaluate(p, tissues, std::span(share).first(tissues.size()), std::span(gradient).first(tissues.size()));
  double alignment = 0;
  for (const TetId t : topology.tets_of_vertex[v]) {
    const auto tissue = std::ranges::find(tissues, mesh.tissues[t]);
    if (tissue == tissues.end()) continue;
    const auto& tet = mesh.tets[t];
    const auto corner = static_cast<std::size_t>(std::ranges::find(tet, v) - tet.begin());
    std::array<Vec3, 3> face;
    for (std::size_t n = 0; n < 3; ++n) face[n] = mesh.points_mm[tet[(corner + 1 + n) % 4]];
    const Vec3 area = cross(face[1] - face[0], face[2] - face[0]);
    const Vec3 outward = dot(area, face[0] - mesh.points_mm[v]) > 0 ? area : -area;
    alignment += dot(gradient[static_cast<std::size_t>(tissue - tissues.begin())], outward);
  }
  return alignment >= 0;
}

}  // namespace anatomesh
