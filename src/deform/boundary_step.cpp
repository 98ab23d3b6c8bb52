#include "deform/boundary_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec.h"

namespace anatomesh {
namespace {

// More tissues at one point than this are all but unheard of; the point is then settled for the first of them.
constexpr std::size_t kMaxTissues = 8;

// Solves the symmetric positive definite system A x = b.
Vec3 solve_symmetric(const Mat3& a, Vec3 b) {
  const Vec3 c0 = {a[0][0], a[1][0], a[2][0]}, c1 = {a[0][1], a[1][1], a[2][1]}, c2 = {a[0][2], a[1][2], a[2][2]};
  const double det = dot(c0, cross(c1, c2));
  return (1 / det) * Vec3{dot(b, cross(c1, c2)), dot(c0, cross(b, c2)), dot(c0, cross(c1, b))};
}

}  // namespace

// Sum over the tissues of (gradient of its share) . (direction from v into it). That direction is the sum of the area
// vectors of the faces opposite to v.
bool is_on_its_side(const TissueMesh& mesh, const MeshTopology& topology, const SurfaceField& field, VertexId v, Vec3 p) {
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

// Damped Gauss-Newton step on the differences of each share from their mean.
Vec3 boundary_step(const SurfaceField& field, Vec3 p, std::span<const TissueId> tissues) {
  const std::size_t n = std::min(tissues.size(), kMaxTissues);
  std::array<double, kMaxTissues> share;
  std::array<Vec3, kMaxTissues> gradient;
  field.evaluate(p, tissues.first(n), std::span(share).first(n), std::span(gradient).first(n));
  double mean_share = 0;
  Vec3 mean_gradient;
  for (std::size_t i = 0; i < n; ++i) {
    mean_share += share[i] / static_cast<double>(n);
    mean_gradient += (1.0 / static_cast<double>(n)) * gradient[i];
  }
  Mat3 normal = {};
  Vec3 rhs;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 g = gradient[i] - mean_gradient;
    rhs -= (share[i] - mean_share) * g;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) normal[r][c] += g[r] * g[c];
    }
  }
  const double trace = normal[0][0] + normal[1][1] + normal[2][2];
  const Vec3 spacing = field.image().spacing_mm;
  const double voxel = std::max({spacing.x, spacing.y, spacing.z});
  if (trace * voxel * voxel < 1e-6) return {};  // far from the boundary: no direction to go
  for (std::size_t r = 0; r < 3; ++r) normal[r][r] += 0.01 * trace;
  const Vec3 step = solve_symmetric(normal, rhs);
  // No farther than half a voxel along any axis: the field changes within one.
  const double voxels =
      std::max({std::abs(step.x) / spacing.x, std::abs(step.y) / spacing.y, std::abs(step.z) / spacing.z});
  return voxels > 0.5 ? (0.5 / voxels) * step : step;
}

}  // namespace anatomesh
