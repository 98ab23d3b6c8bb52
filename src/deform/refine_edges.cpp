#include "deform/refine_edges.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "deform/improve_shapes.h"
#include "deform/split_bridges.h"

namespace anatomesh {
namespace {

constexpr int kRounds = 14;
constexpr double kLong = 4.0 / 3;     // of the size asked for
constexpr double kGoodSlack = 0.1;    // tetrahedra with less are improved between two rounds of splits
constexpr double kSplitSlack = 0.01;  // that the halves have at least

struct Edge {
  double weight;  // the largest first
  VertexId low, high;
  bool operator<(const Edge& b) const {
    return weight != b.weight ? weight > b.weight : low != b.low ? low < b.low : high < b.high;
  }
  bool operator==(const Edge&) const = default;
};

bool is_cut(const MeshEditor& mesh, VertexId a, VertexId b) { return mesh.is_outer(a) && mesh.is_outer(b); }

// The least slack of the tetrahedra that a split at p makes; -2 where there is no such edge. Gives up below `enough`.
double slack_of_halves(const MeshEditor& mesh, const ShapeBounds& bounds, VertexId a, VertexId b, Vec3 p,
                       double enough) {
  double worst = -2;
  for (const TetId t : mesh.tets_at(a)) {
    const auto& tet = mesh.tet(t);
    if (std::ranges::find(tet, b) == tet.end()) continue;
    if (worst == -2) worst = 1;
    for (const VertexId end : {a, b}) {
      std::array<Vec3, 4> c;
      for (std::size_t n = 0; n < 4; ++n) c[n] = tet[n] == end ? p : mesh.point(tet[n]);
      const ShapeBounds& asked = mesh.tissue(t) == 0 ? kCushionBounds : bounds;
      worst = std::min(worst, slack(asked, c[0], c[1], c[2], c[3]));
      if (worst < enough) return worst;
    }
  }
  return worst;
}

bool split_at_middle(MeshEditor& mesh, const ShapeBounds& bounds, VertexId a, VertexId b, double enough) {
  const Vec3 middle = 0.5 * (mesh.point(a) + mesh.point(b));
  if (slack_of_halves(mesh, bounds, a, b, middle, enough) < enough) return false;
  mesh.split(a, b, middle);
  return true;
}

std::vector<Edge> find_long_edges(const MeshEditor& mesh, const std::function<double(Vec3)>& size_at,
                                  std::uint32_t since) {
  std::vector<Edge> edges;
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (!mesh.is_alive(t)) continue;
    const auto& tet = mesh.tet(t);
    if (std::ranges::none_of(tet, [&](VertexId v) { return mesh.changed_at(v) >= since; })) continue;
    for (const auto& [i, j] : kEdgeCorners) {
      const VertexId a = std::min(tet[i], tet[j]), b = std::max(tet[i], tet[j]);
      if (is_cut(mesh, a, b)) continue;
      edges.push_back({0, a, b});
    }
  }
  sort_and_unify(edges);
  std::vector<Edge> found;
  for (Edge& edge : edges) {
    const Vec3 a = mesh.point(edge.low), b = mesh.point(edge.high);
    edge.weight = norm(a - b) / size_at(0.5 * (a + b));
    if (edge.weight > kLong) found.push_back(edge);
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool is_inner(const MeshEditor& mesh, VertexId a, VertexId b) {
  bool first = true, same = true;
  TissueId tissue = 0;
  for (const TetId t : mesh.tets_at(a)) {
    const auto& tet = mesh.tet(t);
    if (std::ranges::find(tet, b) == tet.end()) continue;
    if (first) tissue = mesh.tissue(t);
    same = same && mesh.tissue(t) == tissue;
    first = false;
  }
  return same;
}

std::vector<Edge> find_bridges(const MeshEditor& mesh) {
  std::vector<Edge> edges;
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (!mesh.is_alive(t) || mesh.tissue(t) == 0) continue;
    const auto& tet = mesh.tet(t);
    if (!std::ranges::all_of(tet, [&](VertexId v) { return mesh.tissues_at(v) > 1; })) continue;
    for (const auto& [i, j] : kEdgeCorners) {
      const VertexId a = std::min(tet[i], tet[j]), b = std::max(tet[i], tet[j]);
      if (!is_cut(mesh, a, b) && is_inner(mesh, a, b)) edges.push_back({norm(mesh.point(a) - mesh.point(b)), a, b});
    }
  }
  sort_and_unify(edges);
  return edges;
}

}  // namespace

std::size_t refine_edges(MeshEditor& mesh, const ShapeBounds& bounds, const std::function<double(Vec3)>& size_at,
                         std::size_t max_tets, const Stage& stage) {
  std::size_t splits = 0;
  std::uint32_t since = 0;
  for (int round = 0; round < kRounds; ++round) {
    stage.check_cancelled();
    const std::uint32_t now = mesh.clock() + 1;
    const std::size_t before = splits;
    // Better tetrahedra around the edges that cannot be split now may let them be later.
    std::vector<char> is_at_long_edge(mesh.vertex_count(), 0);
    for (const Edge& edge : find_long_edges(mesh, size_at, since)) {
      if (mesh.tissue_tets() >= max_tets) return splits;
      if (split_at_middle(mesh, bounds, edge.low, edge.high, kSplitSlack)) {
        ++splits;
      } else {
        is_at_long_edge[edge.low] = is_at_long_edge[edge.high] = 1;
      }
    }
    const std::size_t changes = improve_shapes(mesh, bounds, kGoodSlack, stage, round == 0 ? 0 : now, is_at_long_edge);
    since = now;
    if (splits == before && changes == 0) break;
  }
  return splits;
}

std::size_t split_tets(MeshEditor& mesh, const ShapeBounds& bounds, const std::vector<TetId>& tets) {
  std::vector<std::array<VertexId, 4>> marked;
  for (const TetId t : tets) {
    if (mesh.is_alive(t)) marked.push_back(mesh.tet(t));
  }
  std::size_t splits = 0;
  for (const auto& tet : marked) {
    std::vector<Edge> edges;
    for (const auto& [i, j] : kEdgeCorners) {
      if (is_cut(mesh, tet[i], tet[j])) continue;
      edges.push_back(
          {norm(mesh.point(tet[i]) - mesh.point(tet[j])), std::min(tet[i], tet[j]), std::max(tet[i], tet[j])});
    }
    std::sort(edges.begin(), edges.end());
    for (const Edge& edge : edges) {
      if (!split_at_middle(mesh, bounds, edge.low, edge.high, 0)) continue;
      ++splits;
      break;
    }
  }
  return splits;
}

std::size_t split_around(MeshEditor& mesh, const ShapeBounds& bounds, VertexId v) {
  std::vector<Edge> edges;
  for (const TetId t : mesh.tets_at(v)) {
    for (const VertexId w : mesh.tet(t)) {
      if (w != v && !is_cut(mesh, v, w))
        edges.push_back({norm(mesh.point(v) - mesh.point(w)), std::min(v, w), std::max(v, w)});
    }
  }
  sort_and_unify(edges);
  std::size_t splits = 0;
  for (const Edge& edge : edges) splits += split_at_middle(mesh, bounds, edge.low, edge.high, 0);
  return splits;
}

std::size_t split_bridges(MeshEditor& mesh, const ShapeBounds& asked, const Stage& stage) {
  const ShapeBounds bounds = well_shaped(asked);
  std::size_t splits = 0;
  for (std::size_t before = 1; splits != before;) {
    stage.check_cancelled();
    before = splits;
    for (const Edge& edge : find_bridges(mesh)) splits += split_at_middle(mesh, bounds, edge.low, edge.high, 0);
  }
  return splits;
}

}  // namespace anatomesh
