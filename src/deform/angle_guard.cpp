#include "deform/angle_guard.h"

#include "base/parallel.h"

namespace anatomesh {
namespace {

// A move shorter than this share of an edge is not worth its tests.
constexpr double kStill = 0.01;

std::array<Vec3, 4> corners_with(const TissueMesh& mesh, TetId t, VertexId moved, Vec3 p) {
  std::array<Vec3, 4> corners;
  for (std::size_t n = 0; n < 4; ++n) {
    const VertexId v = mesh.tets[t][n];
    corners[n] = v == moved ? p : mesh.points_mm[v];
  }
  return corners;
}

}  // namespace

bool AngleGuard::fits(VertexId v, Vec3 p) const {
  for (const TetId t : topology_.tets_of_vertex[v]) {
    const auto [a, b, c, d] = corners_with(mesh_, t, v, p);
    const ShapeBounds& bounds = mesh_.tissues[t] == 0 ? kCushionBounds : bounds_;
    if (!within(bounds, a, b, c, d)) return false;
  }
  return true;
}

double AngleGuard::advance(VertexId v, Vec3 p, int halvings) const {
  const Vec3 from = mesh_.points_mm[v];
  double share = 1;
  for (int n = 0; n <= halvings; ++n, share *= 0.5) {
    const Vec3 at = from + share * (p - from);
    if (fits(v, at)) {
      mesh_.points_mm[v] = at;
      return share;
    }
  }
  return 0;
}

double AngleGuard::slack(VertexId v, Vec3 p, double enough) const {
  double worst = 1;
  for (const TetId t : topology_.tets_of_vertex[v]) {
    const auto [a, b, c, d] = corners_with(mesh_, t, v, p);
    if (mesh_.tissues[t] == 0) {
      if (!within(kCushionBounds, a, b, c, d)) return -1;
      continue;
    }
    const ShapeMeasure s = measure_shape(a, b, c, d);
    worst = std::min({worst, bounds_.largest_cos - s.largest_cos, s.smallest_cos - bounds_.smallest_cos,
                      s.mean_ratio - bounds_.min_mean_ratio});
    if (worst < enough) return worst;
  }
  return worst;
}

void for_each_vertex_by_colour(const MeshTopology& topology, const Stage& stage,
                               const std::function<void(VertexId)>& visit) {
  for (const auto& colour : topology.colours) {
    stage.check_cancelled();
    parallel_for(
        colour.size(), [&](std::size_t i) { visit(colour[i]); }, 256);
  }
}

void advance_all(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, std::span<const Vec3> goals,
                 int sweeps, const Stage& stage) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for_each_vertex_by_colour(topology, stage, [&](VertexId v) {
      if (goals[v] != mesh.points_mm[v]) guard.advance(v, goals[v], 3);
    });
  }
}

void relax_interior(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const Stage& stage) {
  for_each_vertex_by_colour(topology, stage, [&](VertexId v) {
    if (topology.on_interface(v) || topology.outside(v)) return;
    Vec3 mean;
    for (const VertexId w : topology.neighbours[v]) mean += mesh.points_mm[w];
    mean = (1.0 / static_cast<double>(topology.neighbours[v].size())) * mean;
    const Vec3 from = mesh.points_mm[v], edge = mesh.points_mm[topology.neighbours[v][0]] - from;
    if (norm_squared(mean - from) < kStill * kStill * norm_squared(edge)) return;
    const double before = std::max(0.0, guard.slack(v, from, -1));
    for (const double share : {1.0, 0.3}) {
      const Vec3 at = from + share * (mean - from);
      if (guard.slack(v, at, before) < before) continue;
      mesh.points_mm[v] = at;
      return;
    }
  });
}

}  // namespace anatomesh
