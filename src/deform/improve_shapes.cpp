#include "deform/improve_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/vec.h"
#include "deform/ring_filling.h"
#include "deform/search_directions.h"
#include "mesh/edge_ring.h"
#include "mesh/star_slack.h"

namespace anatomesh {
namespace {

constexpr double kGain = 1e-3;  // of slack; smaller ones could go on for ever

using Tet = std::array<VertexId, 4>;

class ShapeImprover {
 public:
  ShapeImprover(MeshEditor& mesh, const ShapeBounds& bounds) : mesh_(mesh), bounds_(bounds), filling_(mesh) {}

  double slack_of(const Tet& t) const {
    return slack(bounds_, mesh_.point(t[0]), mesh_.point(t[1]), mesh_.point(t[2]), mesh_.point(t[3]));
  }
  // Tries everything on a tetrahedron; whether something was done.
  bool visit(TetId t);

 private:
  bool remove_edge(VertexId a, VertexId b);
  bool remove_face(TetId t, std::size_t opposite);
  bool move_vertex(VertexId v);

  struct Surroundings {
    Vec3 mean;  // of the neighbours
    double shortest2 = std::numeric_limits<double>::infinity();
  };
  Surroundings gather(VertexId v);

  MeshEditor& mesh_;
  const ShapeBounds& bounds_;
  StarSlack star_;
  EdgeRing ring_;
  RingFilling filling_;
  std::vector<Tet> fresh_;
};

bool ShapeImprover::remove_edge(VertexId a, VertexId b) {
  if (!find_ring(mesh_, a, b, ring_)) return false;
  const TissueId tissue = mesh_.tissue(ring_.tets[0]);
  double before = 1;
  for (const TetId t : ring_.all_tets()) {
    if (mesh_.tissue(t) != tissue) return false;
    before = std::min(before, slack_of(mesh_.tet(t)));
  }
  if (filling_.fill(ring_, 0, ring_.size - 1, bounds_, before + kGain) <= before + kGain) return false;
  fresh_.clear();
  filling_.append(0, ring_.size - 1, fresh_);
  mesh_.replace(ring_.all_tets(), fresh_, tissue);
  return true;
}

bool ShapeImprover::remove_face(TetId t, std::size_t opposite) {
  const Tet tet = mesh_.tet(t);
  const auto& order = kCornersFrom[opposite];
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

// The tetrahedra at v go into star_, their other vertices' mean and the shortest edge's square are returned.
ShapeImprover::Surroundings ShapeImprover::gather(VertexId v) {
  const Vec3 at = mesh_.point(v);
  star_.start(bounds_, at);
  Surroundings around;
  for (const TetId t : mesh_.tets_at(v)) {
    const auto others = corners_after(mesh_.tet(t), v);
    std::array<Vec3, 3> other;
    for (std::size_t n = 0; n < 3; ++n) {
      other[n] = mesh_.point(others[n]);
      around.shortest2 = std::min(around.shortest2, norm_squared(other[n] - at));
      around.mean += other[n];
    }
    star_.add(other[0], other[1], other[2], false);
  }
  star_.close();
  // A neighbour counts once for each of its tetrahedra here.
  around.mean = (1.0 / static_cast<double>(3 * mesh_.tets_at(v).size())) * around.mean;
  return around;
}

// A search along fixed directions with steps that get smaller.
bool ShapeImprover::move_vertex(VertexId v) {
  if (mesh_.tissues_at(v) != 1 || mesh_.is_outer(v)) return false;
  const auto [mean, shortest2] = gather(v);
  const Vec3 from = mesh_.point(v);
  Vec3 at = from;
  const double before = star_.at(at, -1);
  double best = before;
  const auto try_at = [&](Vec3 p) {
    const double there = star_.at(p, best + kGain);
    if (there <= best + kGain) return false;
    best = there;
    at = p;
    return true;
  };
  for (const double share : {1.0, 0.5, 0.2}) {
    if (try_at(from + share * (mean - from))) break;
  }
  double step = 0.3 * std::sqrt(shortest2);
  for (int n = 0; n < 5; ++n) {
    bool moved = false;
    for (const Vec3 d : kSearchDirections) moved |= try_at(at + step * d);
    if (!moved) step *= 0.4;
  }
  if (best <= before) return false;
  mesh_.move(v, at);
  return true;
}

bool ShapeImprover::visit(TetId t) {
  const Tet tet = mesh_.tet(t);
  for (const auto& [i, j] : kEdgeCorners) {
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

std::size_t improve_shapes(MeshEditor& mesh, const ShapeBounds& bounds, double enough, const Stage& stage,
                           std::uint32_t since, std::span<const char> around) {
  constexpr TetId kPerCheck = 1 << 14;
  ShapeImprover improver(mesh, bounds);
  std::size_t changes = 0;
  for (TetId t = 0; t < mesh.tet_count(); ++t) {
    if (t % kPerCheck == 0) stage.check_cancelled();
    if (!mesh.is_alive(t) || mesh.tissue(t) == 0) continue;
    const bool is_due = std::ranges::any_of(mesh.tet(t), [&](VertexId v) { return mesh.changed_at(v) >= since; });
    const auto is_near = [&](VertexId v) { return v >= around.size() || around[v]; };
    if (!is_due || std::ranges::none_of(mesh.tet(t), is_near) || improver.slack_of(mesh.tet(t)) >= enough) continue;
    changes += improver.visit(t);
  }
  return changes;
}

}  // namespace anatomesh
