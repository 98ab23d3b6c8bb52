#include "assess/tet_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomesh/assess.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

std::uint8_t dihedral_bin(double deg) {
  constexpr double kWidth = 180.0 / static_cast<double>(Quality::kDihedralBins);
  return static_cast<std::uint8_t>(
      std::min<std::size_t>(static_cast<std::size_t>(deg / kWidth), Quality::kDihedralBins - 1));
}

}  // namespace

TetMeasures measure_tet(const std::array<Vec3, 4>& p) {
  TetMeasures m;
  const double jacobian = dot(cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]);
  m.volume_mm3 = jacobian / 6;
  m.min_dihedral_deg = 180;
  m.min_edge_mm = norm(p[1] - p[0]);
  std::array<double, 4> edge_product = {1, 1, 1, 1};
  double squared_edges = 0;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b, c, d] = kEdgeOfTet[e];
    const Vec3 edge = p[b] - p[a];
    const double length = norm(edge);
    // For the normals m, n of the faces at an edge, |m x n| is |edge| |J|: with the arc tangent the angle is as exact
    // near 0 and 180 degrees as elsewhere.
    const double cosine = dot(cross(edge, p[c] - p[a]), cross(edge, p[d] - p[a]));
    const double deg = std::atan2(length * std::abs(jacobian), cosine) * (180 / std::numbers::pi);
    m.dihedral_bin[e] = dihedral_bin(deg);
    m.min_dihedral_deg = std::min(m.min_dihedral_deg, deg);
    m.max_dihedral_deg = std::max(m.max_dihedral_deg, deg);
    m.min_edge_mm = std::min(m.min_edge_mm, length);
    m.max_edge_mm = std::max(m.max_edge_mm, length);
    squared_edges += length * length;
    edge_product[a] *= length;
    edge_product[b] *= length;
  }
  const double largest = std::max(*std::max_element(edge_product.begin(), edge_product.end()), std::abs(jacobian));
  m.scaled_jacobian = largest > 0 ? std::numbers::sqrt2 * jacobian / largest : 0;
  const double root = std::cbrt(std::max(jacobian, 0.0) / 2);
  m.mean_ratio = squared_edges > 0 ? 12 * root * root / squared_edges : 0;
  return m;
}

std::vector<TetMeasures> measure_tets(const TissueMesh& mesh) {
  std::vector<TetMeasures> measures(mesh.tets.size());
  parallel_for(mesh.tets.size(), [&](std::size_t i) {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.points_mm[mesh.tets[i][k]];
    measures[i] = measure_tet(corners);
  });
  return measures;
}

}  // namespace anatomesh::assess_detail
