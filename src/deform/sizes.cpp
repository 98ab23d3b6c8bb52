#include "deform/sizes.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Mean length of the edges between interface vertices at each; infinity elsewhere.
std::vector<double> sizes_at_interfaces(const MeshEditor& mesh) {
  std::vector<double> sum(mesh.vertex_count()), count(mesh.vertex_count());
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (!mesh.is_alive(t) || mesh.tissue(t) == 0) continue;
    const auto& tet = mesh.tet(t);
    for (const auto& [i, j] : kEdgeCorners) {
      if (mesh.tissues_at(tet[i]) < 2 || mesh.tissues_at(tet[j]) < 2) continue;
      const double length = norm(mesh.point(tet[i]) - mesh.point(tet[j]));
      for (const VertexId v : {tet[i], tet[j]}) {
        sum[v] += length;
        ++count[v];
      }
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    sum[v] = count[v] > 0 ? sum[v] / count[v] : std::numeric_limits<double>::infinity();
  return sum;
}

struct LongEdge {
  double length2;
  VertexId low, high;
  bool operator<(const LongEdge& b) const {
    return length2 != b.length2 ? length2 > b.length2 : low != b.low ? low < b.low : high < b.high;
  }
  bool operator==(const LongEdge&) const = default;
};

std::vector<LongEdge> find_long_edges(const MeshEditor& mesh, const SizeField& sizes) {
  std::vector<LongEdge> edges;
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (!mesh.is_alive(t) || mesh.tissue(t) == 0) continue;
    const auto& tet = mesh.tet(t);
    for (const auto& [i, j] : kEdgeCorners) {
      const Vec3 a = mesh.point(tet[i]), b = mesh.point(tet[j]);
      const double length2 = norm_squared(a - b), size = sizes.at(mesh.tissue(t), 0.5 * (a + b));
      if (length2 > size * size) edges.push_back({length2, std::min(tet[i], tet[j]), std::max(tet[i], tet[j])});
    }
  }
  sort_and_unify(edges);
  return edges;
}

bool halves_fit(const MeshEditor& mesh, const LongEdge& edge, Vec3 middle, const ShapeBounds& bounds) {
  for (const TetId t : mesh.tets_at(edge.low)) {
    const auto& tet = mesh.tet(t);
    if (std::ranges::find(tet, edge.high) == tet.end()) continue;
    for (const VertexId end : {edge.low, edge.high}) {
      std::array<Vec3, 4> p;
      for (std::size_t n = 0; n < 4; ++n) p[n] = tet[n] == end ? middle : mesh.point(tet[n]);
      if (!within(mesh.tissue(t) == 0 ? kCushionBounds : bounds, p[0], p[1], p[2], p[3])) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<double> graded_sizes(const MeshEditor& mesh, double gradation) {
  std::vector<double> sizes = sizes_at_interfaces(mesh);
  using Entry = std::pair<double, VertexId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (VertexId v = 0; v < sizes.size(); ++v) {
    if (sizes[v] < std::numeric_limits<double>::infinity()) queue.emplace(sizes[v], v);
  }
  while (!queue.empty()) {
    const auto [size, v] = queue.top();
    queue.pop();
    if (size > sizes[v]) continue;
    for (const TetId t : mesh.tets_at(v)) {
      for (const VertexId w : mesh.tet(t)) {
        const double there = size + gradation * norm(mesh.point(w) - mesh.point(v));
        if (there >= sizes[w]) continue;
        sizes[w] = there;
        queue.emplace(there, w);
      }
    }
  }
  return sizes;
}

std::size_t split_long_edges(MeshEditor& mesh, const ShapeBounds& bounds, const SizeField& sizes, const Stage& stage) {
  std::size_t splits = 0;
  for (bool changed = true; changed;) {
    stage.check_cancelled();
    changed = false;
    for (const LongEdge& edge : find_long_edges(mesh, sizes)) {
      const Vec3 middle = 0.5 * (mesh.point(edge.low) + mesh.point(edge.high));
      if (!halves_fit(mesh, edge, middle, bounds)) continue;
      mesh.split(edge.low, edge.high, middle);
      changed = true;
      ++splits;
    }
  }
  return splits;
}

}  // namespace anatomesh
