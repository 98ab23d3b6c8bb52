#include "deform/angle_guard.h"

#include <algorithm>

#include "base/parallel.h"

namespace anatomesh {
namespace {

// A move shorter than this share of an edge is not worth its tests.
constexpr double kStill = 0.01;

// An interface vertex looks for the place around it where it is nearest to its goal, with some slack to spare, so that
// its neighbours find theirs.
constexpr double kSpare = 0.05;
constexpr double kReachOfEdge = 5;  // an edge is this many first steps long
constexpr int kSearchRounds = 4;

constexpr double kDiagonal = 0.6;
constexpr std::array<Vec3, 14> kSearchDirections = {Vec3{1, 0, 0},
                                                    Vec3{-1, 0, 0},
                                                    Vec3{0, 1, 0},
                                                    Vec3{0, -1, 0},
                                                    Vec3{0, 0, 1},
                                                    Vec3{0, 0, -1},
                                                    Vec3{kDiagonal, kDiagonal, kDiagonal},
                                                    Vec3{-kDiagonal, -kDiagonal, kDiagonal},
                                                    Vec3{-kDiagonal, kDiagonal, -kDiagonal},
                                                    Vec3{kDiagonal, -kDiagonal, -kDiagonal},
                                                    Vec3{-kDiagonal, -kDiagonal, -kDiagonal},
                                                    Vec3{kDiagonal, kDiagonal, -kDiagonal},
                                                    Vec3{kDiagonal, -kDiagonal, kDiagonal},
                                                    Vec3{-kDiagonal, kDiagonal, kDiagonal}};

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

double AngleGuard::advance_best(VertexId v, Vec3 goal, const Mat3& metric, double reach) const {
  const double share = advance(v, goal, 3);
  const double scale = 1 / (kReachOfEdge * kReachOfEdge * reach * reach);
  const auto of_way = [&](Vec3 at) { return scale * dot(at - goal, metric * (at - goal)); };
  const auto of_slack = [](double slack) { return slack < kSpare ? (kSpare - slack) * (kSpare - slack) : 0; };
  Vec3& best = mesh_.points_mm[v];
  double least = of_way(best) + of_slack(slack(v, best, -1));
  if (share == 1 && least == 0) return 1;
  double radius = reach;
  for (int round = 0; round < kSearchRounds; ++round) {
    const Vec3 centre = best;
    bool moved = false;
    for (const Vec3 direction : kSearchDirections) {
      const Vec3 at = centre + radius * direction;
      const double way = of_way(at);
      if (way >= least) continue;
      const double needed = std::max(0.0, kSpare - std::sqrt(least - way));
      const double s = slack(v, at, needed);
      if (s < needed || way + of_slack(s) >= least) continue;
      best = at;
      least = way + of_slack(s);
      moved = true;
    }
    if (!moved) radius *= 0.5;
  }
  return share;
}

double AngleGuard::slack(VertexId v, Vec3 p, double enough) const {
  double least = 1;
  for (const TetId t : topology_.tets_of_vertex[v]) {
    least = std::min(least, slack_of(t, v, p));
    if (least < enough) break;
  }
  return least;
}

double AngleGuard::slack_of(TetId t, VertexId v, Vec3 p) const {
  const auto [a, b, c, d] = corners_with(mesh_, t, v, p);
  if (mesh_.tissues[t] == 0) return within(kCushionBounds, a, b, c, d) ? 1 : -1;
  const TetGeometry g(a, b, c, d);
  if (!(g.volume6 > 0)) return -1;
  const auto [largest, smallest] = g.cosine_range();
  // The mean ratio's cube needs no cube root; divided by its slope at the bound it is like the ratio itself there.
  const double bound = bounds_.min_mean_ratio;
  const double cube = 432 * g.volume6 * g.volume6 / (g.edges * g.edges * g.edges);
  const double of_ratio = (cube - bound * bound * bound) / (3 * bound * bound);
  return std::min({bounds_.largest_cos - largest, smallest - bounds_.smallest_cos, of_ratio});
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
    const Vec3 from = mesh.points_mm[v];
    const auto neighbours = topology.neighbours[v];
    Vec3 mean;
    double edge = 0;
    for (const VertexId w : neighbours) {
      mean += mesh.points_mm[w];
      edge += norm(mesh.points_mm[w] - from);
    }
    mean = (1.0 / static_cast<double>(neighbours.size())) * mean;
    edge /= static_cast<double>(neighbours.size());
    if (norm_squared(mean - from) >= kStill * kStill * edge * edge) {
      const double before = std::max(0.0, guard.slack(v, from, -1));
      for (const double share : {1.0, 0.3}) {
        const Vec3 at = from + share * (mean - from);
        if (guard.slack(v, at, before) < before) continue;
        mesh.points_mm[v] = at;
        break;
      }
    }
  });
}

}  // namespace anatomesh
