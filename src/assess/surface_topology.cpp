#include "assess/surface_topology.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "assess/statistics.h"
#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

/// An edge of a triangle. Vertices are numbered within the surface; a corner is 3 * triangle + place in it.
struct EdgeUse {
  std::uint32_t low, high;                ///< vertices
  std::uint32_t low_corner, high_corner;  ///< of the triangle at them

  std::uint32_t triangle() const { return low_corner / 3; }
  bool same_edge(const EdgeUse& o) const { return low == o.low && high == o.high; }
  bool operator<(const EdgeUse& o) const {
    return std::tie(low, high, low_corner) < std::tie(o.low, o.high, o.low_corner);
  }
};

/// Vertex of each corner, numbered from 0 within the surface.
std::vector<std::uint32_t> number_corners(std::span<const Triangle> surface, std::size_t& vertex_count) {
  std::vector<VertexId> ids;
  ids.reserve(3 * surface.size());
  for (const Triangle& t : surface) ids.insert(ids.end(), t.begin(), t.end());
  sort_and_unify(ids);
  vertex_count = ids.size();
  std::vector<std::uint32_t> corners(3 * surface.size());
  parallel_for(surface.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), surface[i][k]);
      corners[3 * i + k] = static_cast<std::uint32_t>(at - ids.begin());
    }
  });
  return corners;
}

/// All edges of all triangles, uses of one edge side by side.
std::vector<EdgeUse> list_edges(const std::vector<std::uint32_t>& corners) {
  std::vector<EdgeUse> uses(corners.size());
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t next = c % 3 == 2 ? c - 2 : c + 1;
    const auto [low, high] = std::minmax(c, next, [&](auto a, auto b) { return corners[a] < corners[b]; });
    uses[c] = {corners[low], corners[high], low, high};
  }
  std::sort(uses.begin(), uses.end());
  return uses;
}

double angle_deg(Vec3 a, Vec3 b) { return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi); }

}  // namespace

void measure_surface(std::span<const Triangle> surface, std::span<const Vec3> points_mm, Topology& topology) {
  std::vector<Vec3> normals(surface.size());  // twice the area long
  parallel_for(surface.size(), [&](std::size_t i) {
    const Vec3 a = points_mm[surface[i][0]];
    normals[i] = cross(points_mm[surface[i][1]] - a, points_mm[surface[i][2]] - a);
  });
  std::size_t vertex_count = 0;
  const auto corners = number_corners(surface, vertex_count);
  const auto uses = list_edges(corners);

  DisjointSets parts(surface.size());
  DisjointSets fans(corners.size());  // corners of one vertex, joined across edges
  std::vector<char> on_bad_edge(vertex_count, 0);
  std::vector<double> jumps;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t end = i + 1;
    for (; end < uses.size() && uses[end].same_edge(uses[i]); ++end) {
      parts.join(uses[i].triangle(), uses[end].triangle());
      fans.join(uses[i].low_corner, uses[end].low_corner);
      fans.join(uses[i].high_corner, uses[end].high_corner);
    }
    const std::size_t faces = end - i;
    ++topology.surface_edges;
    topology.odd_edges += faces % 2;
    if (faces == 2) {
      jumps.push_back(angle_deg(normals[uses[i].triangle()], normals[uses[i + 1].triangle()]));
    } else {
      ++topology.nonmanifold_edges;
      on_bad_edge[uses[i].low] = on_bad_edge[uses[i].high] = 1;
    }
    i = end;
  }

  std::vector<std::uint32_t> fan_count(vertex_count, 0);
  for (std::uint32_t c = 0; c < corners.size(); ++c) fan_count[corners[c]] += fans.is_root(c);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    topology.nonmanifold_vertices += fan_count[v] > 1 || on_bad_edge[v];
    topology.pinch_vertices += fan_count[v] > 1 && !on_bad_edge[v];
  }
  topology.surface_vertices = vertex_count;
  topology.surface_faces = surface.size();
  for (const Vec3& n : normals) topology.surface_area_mm2 += norm(n) / 2;
  topology.surface_components = parts.count_sets();
  topology.surface_euler =
      static_cast<std::int64_t>(vertex_count + surface.size()) - static_cast<std::int64_t>(topology.surface_edges);
  topology.closed = topology.odd_edges == 0;
  if (!jumps.empty()) {
    const double sum = std::accumulate(jumps.begin(), jumps.end(), 0.0);
    topology.normal_jump_mean_deg = sum / static_cast<double>(jumps.size());
    topology.normal_jump_p95_deg = percentile(jumps, 95);
  }
}

}  // namespace anatomesh::assess_detail
