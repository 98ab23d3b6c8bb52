// Edge removal by dynamic programming: G. T. Klincsek, "Minimal triangulations of polygonal domains", 1980, as used by
// J. R. Shewchuk, "Two discrete optimization algorithms for the topological improvement of tetrahedral meshes", 2002.
#include "deform/improve_shapes.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/vec.h"
#include "mesh/edge_ring.h"
#include "mesh/vertex_star.h"

namespace anatomesh {
namespace {

constexpr double kGain = 1e-3;  // of slack; smaller ones could go on for ever

using Tet = std::array<VertexId, 4>;

class ShapeImprover {
 public:
  ShapeImprover(MeshEditor& mesh, const ShapeBounds& bounds) : mesh_(mesh), bounds_(bounds), star_(mesh) {}

  double slack_of(const Tet& t) const {
    return slack(bounds_, mesh_.point(t[0]), mesh_.point(t[1]), mesh_.point(t[2]), mesh_.point(t[3]));
  }
  // Tries everything on a tetrahedron; whether something was done.
  bool visit(TetId t);

 private:
  bool remove_edge(VertexId a, VertexId b);
  bool remove_face(TetId t, std::size_t opposite);
  bool move_vertex(VertexId v);

  double fill_polygons(double enough);
  void append_polygon(std::size_t i, std::size_t j);
  double worst_at(Vec3 p, double enough) const;

  MeshEditor& mesh_;
  const ShapeBounds& bounds_;
  VertexStar star_;
  EdgeRing ring_;
  std::vector<Tet> fresh_;
  // Of the polygon link[i] .. link[j]: the best it can be filled, and the corner of the triangle at ij that does so.
  std::array<std::array<double, EdgeRing::kMax>, EdgeRing::kMax> best_;
  std::array<std::array<std::size_t, EdgeRing::kMax>, EdgeRing::kMax> apex_;
};

// Returns the worst slack of the best filling of the ring.
double ShapeImprover::fill_polygons(double enough) {
  const std::size_t n = ring_.size;
  for (std::size_t i = 0; i + 1 < n; ++i) best_[i][i + 1] = 1;
  for (std::size_t width = 2; width < n; ++width) {
    for (std::size_t i = 0; i + width < n; ++i) {
      const std::size_t j = i + width;
      best_[i][j] = -2;
      for (std::size_t k = i + 1; k < j; ++k) {
        double worst = std::min(best_[i][k], best_[k][j]);
        const double wanted = std::max(enough, best_[i][j]);
        if (worst <= wanted) continue;
        const VertexId x = ring_.link[i], y = ring_.link[k], z = ring_.link[j];
        worst = std::min(worst, slack_of({x, y, z, ring_.b}));
        if (worst > wanted) worst = std::min(worst, slack_of({y, x, z, ring_.a}));
        if (worst <= best_[i][j]) continue;
        best_[i][j] = worst;
        apex_[i][j] = k;
      }
    }
  }
  return best_[0][n - 1];
}

void ShapeImprover::append_polygon(std::size_t i, std::size_t j) {
  if (j == i + 1) return;
  const std::size_t k = apex_[i][j];
  fresh_.push_back({ring_.link[i], ring_.link[k], ring_.link[j], ring_.b});
  fresh_.push_back({ring_.link[k], ring_.link[i], ring_.link[j], ring_.a});
  append_polygon(i, k);
  append_polygon(k, j);
}

bool ShapeImprover::remove_edge(VertexId a, VertexId b) {
  if (!find_ring(mesh_, a, b, ring_)) return false;
  const TissueId tissue = mesh_.tissue(ring_.tets[0]);
  double before = 1;
  for (const TetId t : ring_.all_tets()) {
    if (mesh_.tissue(t) != tissue) return false;
    before = std::min(before, slack_of(mesh_.tet(t)));
  }
  if (fill_polygons(before + kGain) <= before + kGain) return false;
  fresh_.clear();
  append_polygon(0, ring_.size - 1);
  mesh_.replace(ring_.all_tets(), fresh_, tissue);
  return true;
}

bool ShapeImprover::remove_face(TetId t, std::size_t opposite) {
  // Even permutations that begin with the opposite corner.
  constexpr std::array<std::array<std::size_t, 4>, 4> kFrom = {
      {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
  const Tet tet = mesh_.tet(t);
  const auto& order = kFrom[opposite];
  const VertexId a = tet[order[0]], x = tet[order[1]], y = tet[order[2]], z = tet[order[3]];
  TetId other = t;
  for (const TetId s : mesh_.tets_at(x)) {
    const Tet& c = mesh_.tet(s);
    if (s != t && std::ranges::find(c, y) != c.end() && std::ranges::find(c, z) != c.end()) other = s;
  }
  if (other == t || mesh_.tissue(other) != mesh_.tissue(t)) return false;
  const VertexId b = *std::ranges::find_if(mesh_.tet(other), [&](VertexId v) { return v != x && v != y && v != z; });
  const double before = std::min(slack_of(tet), slack_of(mesh_.tet(other))) + kGain;
  const std::array<Tet, 3> fresh = {{{a, x, y, b}, {a, y, z, b}, {a, z, x, b}}};
  for (const Tet& f : fresh) {
    if (slack_of(f) <= before) return false;
  }
  mesh_.replace(std::array{t, other}, fresh, mesh_.tissue(t));
  return true;
}

// Of the star's tetrahedra with its centre at p; gives up below `enough`.
double ShapeImprover::worst_at(Vec3 p, double enough) const {
  double worst = 1;
  for (const auto& tet : star_.tets()) {
    std::array<Vec3, 4> c;
    for (std::size_t n = 0; n < 4; ++n) c[n] = tet.corners[n] == 0 ? p : star_.points()[tet.corners[n]];
    worst = std::min(worst, slack(bounds_, c[0], c[1], c[2], c[3]));
    if (worst < enough) break;
  }
  return worst;
}

// A search along fixed directions with steps that get smaller.
bool ShapeImprover::move_vertex(VertexId v) {
  constexpr std::array<Vec3, 14> kDirections = {{{1, 0, 0},
                                                 {-1, 0, 0},
                                                 {0, 1, 0},
                                                 {0, -1, 0},
                                                 {0, 0, 1},
                                                 {0, 0, -1},
                                                 {.577, .577, .577},
                                                 {.577, .577, -.577},
                                                 {.577, -.577, .577},
                                                 {.577, -.577, -.577},
                                                 {-.577, .577, .577},
                                                 {-.577, .577, -.577},
                                                 {-.577, -.577, .577},
                                                 {-.577, -.577, -.577}}};
  if (mesh_.tissues_at(v) != 1 || mesh_.is_outer(v)) return false;
  star_.gather(v);
  Vec3 at = star_.points()[0], mean;
  double shortest2 = norm_squared(star_.points()[1] - at);
  for (std::size_t n = 1; n < star_.points().size(); ++n) {
    shortest2 = std::min(shortest2, norm_squared(star_.points()[n] - at));
    mean += star_.points()[n];
  }
  mean = (1.0 / static_cast<double>(star_.points().size() - 1)) * mean;
  const double before = worst_at(at, -2);
  double best = before;
  const auto try_at = [&](Vec3 p) {
    const double there = worst_at(p, best + kGain);
    if (there <= best + kGain) return false;
    best = there;
    at = p;
    return true;
  };
  for (const double share : {1.0, 0.5, 0.2}) {
    if (try_at(star_.points()[0] + share * (mean - star_.points()[0]))) break;
  }
  double step = 0.3 * std::sqrt(shortest2);
  for (int n = 0; n < 5; ++n) {
    bool moved = false;
    for (const Vec3 d : kDirections) moved |= try_at(at + step * d);
    if (!moved) step *= 0.4;
  }
  if (best <= before) return false;
  mesh_.move(v, at);
  return true;
}

bool ShapeImprover::visit(TetId t) {
  constexpr std::array<std::array<std::size_t, 2>, 6> kEdges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  const Tet tet = mesh_.tet(t);
  for (const auto& [i, j] : kEdges) {
    if (remove_edge(tet[i], tet[j])) return true;
  }
  for (std::size_t n = 0; n < 4; ++n) {
    if (remove_face(t, n)) return true;
  }
  bool moved = false;
  for (const VertexId v : tet) moved |= move_vertex(v);
  return moved;
}

}  // namespace

std::size_t improve_shapes(MeshEditor& mesh, const ShapeBounds& bounds, double enough, const Stage& stage) {
  constexpr TetId kPerCheck = 1 << 14;
  ShapeImprover improver(mesh, bounds);
  std::size_t changes = 0;
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (t % kPerCheck == 0) stage.check_cancelled();
    if (!mesh.is_alive(t) || mesh.tissue(t) == 0 || improver.slack_of(mesh.tet(t)) >= enough) continue;
    changes += improver.visit(t);
  }
  return changes;
}

}  // namespace anatomesh
