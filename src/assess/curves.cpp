#include "assess/curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "anatomesh/errors.h"
#include "assess/tissue_mesh.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/curved_shape.h"

namespace anatomesh::assess_detail {
namespace {

constexpr double kStraight = 1e-9;  // of the chord
constexpr std::size_t kGrain = 4096;

void check_edge_nodes(const TetMesh& mesh) {
  check_mesh(mesh);
  if (mesh.edge_nodes.size() != mesh.tets.size()) {
    throw InvalidInput("the mesh has " + std::to_string(mesh.tets.size()) + " tetrahedra but edge nodes of " +
                       std::to_string(mesh.edge_nodes.size()) + "; all must have them, or none");
  }
  for (const auto& nodes : mesh.edge_nodes) {
    const auto bad = std::ranges::find_if(nodes, [&](VertexId v) { return v >= mesh.points_mm.size(); });
    if (bad == nodes.end()) continue;
    throw InvalidInput("a tetrahedron has the edge node " + std::to_string(*bad) + " but the mesh has only " +
                       std::to_string(mesh.points_mm.size()) + " points");
  }
}

CurvedTet tet_at(const TetMesh& mesh, std::size_t t) {
  CurvedTet tet;
  for (std::size_t n = 0; n < 4; ++n) tet.corners[n] = mesh.points_mm[mesh.tets[t][n]];
  for (std::size_t n = 0; n < 6; ++n) tet.edge_nodes[n] = mesh.points_mm[mesh.edge_nodes[t][n]];
  return tet;
}

bool is_curved(const CurvedTet& tet) {
  for (std::size_t e = 0; e < 6; ++e) {
    const Vec3 a = tet.corners[kEdgeNodeCorners[e][0]], b = tet.corners[kEdgeNodeCorners[e][1]];
    if (norm(tet.edge_nodes[e] - 0.5 * (a + b)) > kStraight * norm(b - a)) return true;
  }
  return false;
}

/// Of some tetrahedra; angles as cosines.
struct Sum {
  Curves counts;
  TetGeometry::CosineRange cosines;
  double least_jacobian = 1;

  void add(const CurvedTet& tet) {
    const double least = anatomesh::least_jacobian(tet);
    const auto cosine = corner_angles(tet);
    ++counts.tets;
    counts.curved_tets += is_curved(tet);
    counts.folded += !(least > 0);
    least_jacobian = std::min(least_jacobian, least);
    cosines.largest = std::max(cosines.largest, cosine.largest);
    cosines.smallest = std::min(cosines.smallest, cosine.smallest);
  }

  void add(const Sum& other) {
    counts.tets += other.counts.tets;
    counts.curved_tets += other.counts.curved_tets;
    counts.folded += other.counts.folded;
    least_jacobian = std::min(least_jacobian, other.least_jacobian);
    cosines.largest = std::max(cosines.largest, other.cosines.largest);
    cosines.smallest = std::min(cosines.smallest, other.cosines.smallest);
  }
};

double degrees(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi; }

}  // namespace

Curves measure_curves(const TetMesh& mesh) {
  check_edge_nodes(mesh);
  std::vector<Sum> parts((mesh.tets.size() + kGrain - 1) / kGrain);
  parallel_blocks(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (mesh.labels[t] != 0) parts[begin / kGrain].add(tet_at(mesh, t));
    }
  });
  Sum sum;
  for (const Sum& part : parts) sum.add(part);
  Curves curves = sum.counts;
  if (curves.tets == 0) return curves;
  curves.min_jacobian = sum.least_jacobian;
  curves.min_dihedral_deg = degrees(sum.cosines.largest);
  curves.max_dihedral_deg = degrees(sum.cosines.smallest);
  return curves;
}

}  // namespace anatomesh::assess_detail
