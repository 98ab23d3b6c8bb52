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

}  // namespace

// The tetrahedra at v; good until the thread's next call.
const StarSlack& AngleGuard::star(VertexId v) const {
  static thread_local StarSlack star;
  star.start(bounds_, mesh_.points_mm[v]);
  for (const TetId t : topology_.tets_of_vertex[v]) {
    const auto [b, c, d] = corners_after(mesh_.tets[t], v);
    star.add(mesh_.points_mm[b], mesh_.points_mm[c], mesh_.points_mm[d], mesh_.tissues[t] == 0);
  }
  star.close();
  return star;
}

double AngleGuard::advance(VertexId v, Vec3 p, int halvings) const {
  return is_fixed(v) ? 0 : advance(star(v), v, p, halvings);
}

double AngleGuard::advance(const StarSlack& star, VertexId v, Vec3 p, int halvings) const {
  const Vec3 from = mesh_.points_mm[v];
  double share = 1;
  for (int n = 0; n <= halvings; ++n, share *= 0.5) {
    const Vec3 at = from + share * (p - from);
    if (star.fits(at)) {
      mesh_.points_mm[v] = at;
      return share;
    }
  }
  return 0;
}

double AngleGuard::advance_best(VertexId v, Vec3 goal, const Mat3& metric, double reach) const {
  if (is_fixed(v)) return 0;
  const StarSlack& around = star(v);
  const double share = advance(around, v, goal, 3);
  const double scale = 1 / (kReachOfEdge * kReachOfEdge * reach * reach);
  const auto of_way = [&](Vec3 at) { return scale * dot(at - goal, metric * (at - goal)); };
  const auto of_slack = [](double slack) { return slack < kSpare ? (kSpare - slack) * (kSpare - slack) : 0; };
  Vec3& best = mesh_.points_mm[v];
  double least = of_way(best) + of_slack(around.at(best, -1));
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
      const double s = around.at(at, needed);
      if (s < needed || way + of_slack(s) >= least) continue;
      best = at;
      least = way + of_slack(s);
      moved = true;
    }
    if (!moved) radius *= 0.5;
  }
  return share;
}

void AngleGuard::make_even(VertexId v, Vec3 mean) const {
  if (is_fixed(v)) return;
  const StarSlack& around = star(v);
  const Vec3 from = mesh_.points_mm[v];
  const double before = std::max(0.0, around.at(from, -1));
  for (const double share : {1.0, 0.3}) {
    const Vec3 at = from + share * (mean - from);
    if (around.at(at, before) < before) continue;
    mesh_.points_mm[v] = at;
    break;
  }
}

void for_each_vertex_by_colour(const MeshTopology& topology, const Stage& stage,
                               const std::function<void(VertexId)>& visit) {
  for (const auto& colour : topology.colours) {
    stage.check_cancelled();
    parallel_for(
        colour.size(),
        [&](std::size_t i) {
          for (VertexId v = colour[i].begin; v < colour[i].end; ++v) visit(v);
        },
        1);
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
    if (norm_squared(mean - from) >= kStill * kStill * edge * edge) guard.make_even(v, mean);
  });
}

}  // namespace anatomesh
