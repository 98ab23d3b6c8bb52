#include "anatomesh/quadratic.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/curved_shape.h"
#include "mesh/surface_bends.h"
#include "mesh/tet_shape.h"

namespace anatomesh {
namespace {

constexpr double kLeastJacobian = 0.3;
constexpr double kRounding = 1e-12;  // of cosines

struct Edge {
  VertexId from = 0, to = 0;
  bool operator==(const Edge&) const = default;
  auto operator<=>(const Edge&) const = default;
};

/// The edges of a mesh, ascending, and for each tetrahedron the positions of its own among them.
struct MeshEdges {
  std::vector<Edge> edges;
  std::vector<std::array<VertexId, 6>> of_tet;
};

MeshEdges edges_of(const TetMesh& mesh) {
  struct Place {
    Edge edge;
    std::uint64_t side;  // 6 tet + number of the edge
  };
  std::vector<Place> places(6 * mesh.tets.size());
  parallel_for(mesh.tets.size(), [&](std::size_t t) {
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [low, high] = std::minmax(mesh.tets[t][kEdgeNodeCorners[e][0]], mesh.tets[t][kEdgeNodeCorners[e][1]]);
      places[6 * t + e] = {{low, high}, 6 * t + e};
    }
  });
  std::ranges::sort(places, {}, &Place::edge);
  MeshEdges result;
  result.of_tet.resize(mesh.tets.size());
  for (const Place& place : places) {
    if (result.edges.empty() || result.edges.back() != place.edge) result.edges.push_back(place.edge);
    result.of_tet[place.side / 6][place.side % 6] = static_cast<VertexId>(result.edges.size() - 1);
  }
  return result;
}

/// Bends edges as far as their tetrahedra allow.
class EdgeBender {
 public:
  EdgeBender(const TetMesh& mesh, const MeshEdges& edges, const CurveBounds& bounds)
      : mesh_(mesh),
        edges_(edges),
        bounds_(ShapeBounds::from_degrees(bounds.min_dihedral_deg, bounds.max_dihedral_deg, 0)),
        bows_(edges.edges.size()),
        halvings_(edges.edges.size()) {
    for (const EdgeBend& bend : surface_bends(mesh)) {
      const auto at = std::ranges::lower_bound(edges.edges, Edge{bend.from, bend.to});
      bows_[static_cast<std::size_t>(at - edges.edges.begin())] = bend.bow_mm;
    }
  }

  /// The nodes on all edges.
  std::vector<Vec3> nodes() {
    while (straighten_bad_tets()) continue;
    std::vector<Vec3> nodes(edges_.edges.size());
    for (std::size_t e = 0; e < nodes.size(); ++e) nodes[e] = node(e);
    return nodes;
  }

 private:
  Vec3 node(std::size_t e) const {
    return 0.5 * (mesh_.points_mm[edges_.edges[e].from] + mesh_.points_mm[edges_.edges[e].to]) + bows_[e];
  }

  bool is_straight(std::size_t e) const { return bows_[e] == Vec3{}; }

  bool is_good(std::size_t t) const {
    const auto& edges = edges_.of_tet[t];
    if (std::ranges::all_of(edges, [&](VertexId e) { return is_straight(e); })) return true;
    CurvedTet tet;
    for (std::size_t n = 0; n < 4; ++n) tet.corners[n] = mesh_.points_mm[mesh_.tets[t][n]];
    for (std::size_t n = 0; n < 6; ++n) tet.edge_nodes[n] = node(edges[n]);
    const auto& [a, b, c, d] = tet.corners;
    const auto straight = TetGeometry(a, b, c, d).cosine_range(), curved = corner_angles(tet);
    return curved.largest <= std::max(bounds_.largest_cos, straight.largest) + kRounding &&
           curved.smallest >= std::min(bounds_.smallest_cos, straight.smallest) - kRounding &&
           least_jacobian(tet) >= kLeastJacobian;
  }

  /// Halves the bows of tetrahedra that are not good; the fourth time nothing is left of them. Whether there were any.
  bool straighten_bad_tets() {
    std::vector<char> is_bad(mesh_.tets.size());
    parallel_for(mesh_.tets.size(), [&](std::size_t t) { is_bad[t] = needs_look(t) && !is_good(t); });
    std::vector<char> is_halved(bows_.size());
    bool any = false;
    for (std::size_t t = 0; t < is_bad.size(); ++t) {
      if (!is_bad[t]) continue;
      for (const VertexId e : edges_.of_tet[t]) is_halved[e] |= !is_straight(e);
      any = true;
    }
    for (std::size_t e = 0; e < bows_.size(); ++e) {
      if (is_halved[e]) bows_[e] = (++halvings_[e] < 4 ? 0.5 : 0.0) * bows_[e];
    }
    has_changed_ = std::move(is_halved);
    return any;
  }

  bool needs_look(std::size_t t) const {
    return has_changed_.empty() ||
           std::ranges::any_of(edges_.of_tet[t], [&](VertexId e) { return has_changed_[e] != 0; });
  }

  const TetMesh& mesh_;
  const MeshEdges& edges_;
  ShapeBounds bounds_;
  std::vector<Vec3> bows_;              // by edge
  std::vector<std::uint8_t> halvings_;  // by edge
  std::vector<char> has_changed_;       // by edge, in the last round; empty: before the first
};

}  // namespace

TetMesh quadratic_mesh(const TetMesh& mesh, const CurveBounds& bounds) {
  TetMesh result = linear_mesh(mesh);
  const MeshEdges edges = edges_of(result);
  const std::size_t corners = result.points_mm.size();
  if (corners + edges.edges.size() > std::numeric_limits<VertexId>::max()) {
    throw InvalidInput("the mesh has " + std::to_string(corners) + " vertices and " +
                       std::to_string(edges.edges.size()) + " edges; at most 4294967295 of both can have nodes");
  }
  const std::vector<Vec3> nodes = EdgeBender(result, edges, bounds).nodes();
  result.points_mm.insert(result.points_mm.end(), nodes.begin(), nodes.end());
  result.edge_nodes = edges.of_tet;
  for (auto& of_tet : result.edge_nodes) {
    for (VertexId& node : of_tet) node += static_cast<VertexId>(corners);
  }
  return result;
}

TetMesh linear_mesh(const TetMesh& mesh) {
  TetMesh result = mesh;
  if (mesh.edge_nodes.empty()) return result;
  result.edge_nodes.clear();
  std::vector<char> is_dropped(mesh.points_mm.size());
  for (const auto& nodes : mesh.edge_nodes) {
    for (const VertexId node : nodes) is_dropped[node] = 1;
  }
  for (const auto& tet : mesh.tets) {
    for (const VertexId corner : tet) is_dropped[corner] = 0;
  }
  std::vector<VertexId> number(mesh.points_mm.size());
  result.points_mm.clear();
  for (std::size_t v = 0; v < number.size(); ++v) {
    number[v] = static_cast<VertexId>(result.points_mm.size());
    if (!is_dropped[v]) result.points_mm.push_back(mesh.points_mm[v]);
  }
  for (auto& tet : result.tets) {
    for (VertexId& corner : tet) corner = number[corner];
  }
  return result;
}

}  // namespace anatomesh
