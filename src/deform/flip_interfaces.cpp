#include "deform/flip_interfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "boundary/interface_level.h"
#include "deform/ring_filling.h"
#include "mesh/edge_ring.h"

namespace anatomesh {
namespace {

constexpr double kGoodSlack = 0.03;      // a flip for smoothness may make tetrahedra as bad as this
constexpr double kGain = 1e-3;           // of slack
constexpr double kSmootherBy = 0.01;     // sum over five edges of 1 - cos(angle)
constexpr double kLargestTurnCos = 0.8;  // between the two faces, before and after
constexpr double kNearVoxels = 0.1;      // the new edge's middle from the boundary, if farther than the old one's

// An edge at which two tissues meet in the ordinary way.
struct InterfaceEdge {
  EdgeRing ring;
  std::size_t turn;  ///< link[0] and link[turn] are on the interface; the tetrahedra up to turn have the first tissue
};

class Flipper {
 public:
  Flipper(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds)
      : mesh_(mesh), field_(field), bounds_(bounds), filling_(mesh) {}

  bool visit(VertexId a, VertexId b);

 private:
  bool find(VertexId a, VertexId b, InterfaceEdge& edge) const;
  double smoother_by(VertexId a, VertexId b, VertexId c, VertexId instead);
  bool may_flip(VertexId a, VertexId b, VertexId c, VertexId d, double& gain);
  bool stays_near(const InterfaceEdge& edge) const;
  double distance(VertexId a, VertexId b, TissueId s, TissueId t) const;
  double worst_slack(const InterfaceEdge& edge) const;
  bool fill(std::size_t first, std::size_t last, double wanted);
  void replace(const InterfaceEdge& edge);

  MeshEditor& mesh_;
  const SurfaceField& field_;
  const ShapeBounds& bounds_;
  RingFilling filling_;
  InterfaceEdge edge_, rim_;
  std::vector<std::array<VertexId, 4>> fresh_;
};

bool Flipper::find(VertexId a, VertexId b, InterfaceEdge& edge) const {
  EdgeRing& ring = edge.ring;
  if (!find_ring(mesh_, a, b, ring)) return false;
  const auto tissue = [&](std::size_t n) { return mesh_.tissue(ring.tets[n % ring.size]); };
  std::size_t first = 0;
  while (first < ring.size && tissue(first) == tissue(first + ring.size - 1)) ++first;
  if (first == ring.size) return false;
  std::rotate(ring.link.begin(), ring.link.begin() + first, ring.link.begin() + ring.size);
  std::rotate(ring.tets.begin(), ring.tets.begin() + first, ring.tets.begin() + ring.size);
  edge.turn = 1;
  while (tissue(edge.turn) == tissue(0)) ++edge.turn;
  for (std::size_t n = edge.turn; n < ring.size; ++n) {
    if (tissue(n) != tissue(edge.turn)) return false;
  }
  return true;
}

// 1 - cos of the angle between the faces abc and abd, which lie on different sides of ab.
double roughness_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 m = cross(b - a, c - a), n = cross(d - a, b - a);
  return 1 - dot(m, n) / std::sqrt(norm_squared(m) * norm_squared(n));
}

// By how much the angle at the edge ab gets smaller when its face abc is replaced by the face with `instead`.
double Flipper::smoother_by(VertexId a, VertexId b, VertexId c, VertexId instead) {
  if (!find(a, b, rim_)) return 0;
  const VertexId x = rim_.ring.link[0], y = rim_.ring.link[rim_.turn];
  if (x != c && y != c) return 0;
  const Vec3 p = mesh_.point(a), q = mesh_.point(b), other = mesh_.point(x == c ? y : x);
  return roughness_between(p, q, mesh_.point(c), other) - roughness_between(p, q, mesh_.point(instead), other);
}

// Whether both faces, before and after, are nearly in one plane; `gain`: how much smoother the interface gets.
bool Flipper::may_flip(VertexId a, VertexId b, VertexId c, VertexId d, double& gain) {
  const Vec3 p = mesh_.point(a), q = mesh_.point(b), r = mesh_.point(c), s = mesh_.point(d);
  const double before = roughness_between(p, q, r, s), after = roughness_between(r, s, p, q);
  if (before > 1 - kLargestTurnCos || !(after <= 1 - kLargestTurnCos)) return false;
  gain = before - after;
  // abc, abd -> acd, bcd
  gain += smoother_by(a, c, b, d) + smoother_by(b, c, a, d) + smoother_by(a, d, b, c) + smoother_by(b, d, a, c);
  return true;
}

double Flipper::distance(VertexId a, VertexId b, TissueId s, TissueId t) const {
  return distance_from_boundary(field_, 0.5 * (mesh_.point(a) + mesh_.point(b)), s, t);
}

bool Flipper::stays_near(const InterfaceEdge& edge) const {
  const EdgeRing& ring = edge.ring;
  const TissueId s = mesh_.tissue(ring.tets[0]), t = mesh_.tissue(ring.tets[edge.turn]);
  const Vec3 voxel = field_.image().spacing_mm;
  const double near = kNearVoxels * std::min({voxel.x, voxel.y, voxel.z});
  const double after = distance(ring.link[0], ring.link[edge.turn], s, t);
  return after <= near || after <= distance(ring.a, ring.b, s, t);
}

double Flipper::worst_slack(const InterfaceEdge& edge) const {
  double worst = 1;
  for (const TetId t : edge.ring.all_tets()) {
    if (mesh_.tissue(t) == 0) continue;
    const auto& [a, b, c, d] = mesh_.tet(t);
    worst = std::min(worst, slack(bounds_, mesh_.point(a), mesh_.point(b), mesh_.point(c), mesh_.point(d)));
  }
  return worst;
}

void Flipper::replace(const InterfaceEdge& edge) {
  const EdgeRing& ring = edge.ring;
  const TissueId first = mesh_.tissue(ring.tets[0]), second = mesh_.tissue(ring.tets[edge.turn]);
  fresh_.clear();
  filling_.append(0, edge.turn, fresh_);
  mesh_.replace(ring.all_tets().first(edge.turn), fresh_, first);
  fresh_.clear();
  filling_.append(edge.turn, ring.size, fresh_);
  mesh_.replace(ring.all_tets().subspan(edge.turn), fresh_, second);
}

bool Flipper::fill(std::size_t first, std::size_t last, double wanted) {
  if (mesh_.tissue(edge_.ring.tets[first]) == 0) return filling_.fill(edge_.ring, first, last, kCushionBounds, 0) > 0;
  return filling_.fill(edge_.ring, first, last, bounds_, wanted) > wanted;
}

bool Flipper::visit(VertexId a, VertexId b) {
  if (!find(a, b, edge_)) return false;
  const EdgeRing& ring = edge_.ring;
  if (edge_.turn < 2 || ring.size - edge_.turn < 2) return false;
  double gain = 0;
  if (!may_flip(a, b, ring.link[0], ring.link[edge_.turn], gain) || gain < -kSmootherBy) return false;
  const double before = worst_slack(edge_);
  const double wanted = gain > kSmootherBy ? std::min(before, kGoodSlack) : before + kGain;
  if (gain <= kSmootherBy && before > kGoodSlack) return false;
  if (!stays_near(edge_) || !fill(0, edge_.turn, wanted) || !fill(edge_.turn, ring.size, wanted)) return false;
  replace(edge_);
  return true;
}

}  // namespace

std::size_t flip_interfaces(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds, const Stage& stage,
                            std::uint32_t since) {
  constexpr VertexId kPerCheck = 1 << 14;
  Flipper flipper(mesh, field, bounds);
  std::vector<VertexId> neighbours;
  std::size_t flips = 0;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (v % kPerCheck == 0) stage.check_cancelled();
    if (mesh.tissues_at(v) < 2) continue;
    neighbours.clear();
    for (const TetId t : mesh.tets_at(v)) {
      for (const VertexId w : mesh.tet(t)) {
        if (w > v && mesh.tissues_at(w) > 1) neighbours.push_back(w);
      }
    }
    sort_and_unify(neighbours);
    for (const VertexId w : neighbours) {
      if (std::max(mesh.changed_at(v), mesh.changed_at(w)) >= since) flips += flipper.visit(v, w);
    }
  }
  return flips;
}

}  // namespace anatomesh
