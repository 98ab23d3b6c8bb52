// The link condition for complexes of several strata: T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology
// preserving edge contraction", Publ. Inst. Math. 66, 1999; F. Vivodtzev, G.-P. Bonneau, P. Le Texier, "Topology
// preserving simplification of 2D non-manifold meshes with embedded structures", The Visual Computer 21, 2005.
#include "deform/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec.h"
#include "boundary/interface_level.h"
#include "mesh/vertex_star.h"

namespace anatomesh {
namespace {

using Local = VertexStar::Local;

// A set of tissues out of those at the vertex that is to go, at most three; all others are one more.
using TissueSet = std::uint8_t;

constexpr double kMargin = 1e-9;  // of slack, above its rounding errors

class Coarsener {
 public:
  Coarsener(MeshEditor& mesh, const SurfaceField& field, const CoarsenLimits& limits)
      : mesh_(mesh), field_(field), limits_(limits), star_(mesh) {}

  // Collapses v where that can be; whether it has.
  bool visit(VertexId v);

  // The vertices at v before the last collapse.
  const std::vector<VertexId>& touched() const { return star_.vertices(); }

 private:
  struct Candidate {
    Local vertex;
    double slack;
  };

  TissueSet set_of(TissueId tissue) const;
  void list_tissues();
  bool list_candidates();
  bool keeps_sizes(Local w) const;
  double worst_slack(Local w, double enough) const;
  bool keeps_link(Local w);
  bool keeps_edge_link(Local w) const;
  bool keeps_face_link(Local w) const;
  TissueId tissue_across(Local w, Local x, Local y) const;
  bool keeps_turns(Local w) const;
  bool stays_near(Local w) const;

  MeshEditor& mesh_;
  const SurfaceField& field_;
  const CoarsenLimits& limits_;
  VertexStar star_;
  std::vector<TissueId> tissues_;            // at the centre; where it is on an interface
  std::vector<VertexStar::Face> interface_;  // interface faces at the centre
  std::vector<TissueSet> at_edge_;           // by neighbour: tissues around its edge to the centre
  std::vector<Candidate> candidates_;
  std::vector<TissueSet> at_other_edge_, at_face_;  // by neighbour x: tissues at the edge wx, at the face vwx
  std::vector<char> is_near_other_, is_in_ring_;
};

TissueSet Coarsener::set_of(TissueId tissue) const {
  return static_cast<TissueSet>(1u << (std::ranges::find(tissues_, tissue) - tissues_.begin()));
}

void Coarsener::list_tissues() {
  tissues_.clear();
  for (const auto& tet : star_.tets()) {
    if (std::ranges::find(tissues_, tet.tissue) == tissues_.end()) tissues_.push_back(tet.tissue);
  }
  at_edge_.assign(star_.vertices().size(), 0);
  for (const auto& tet : star_.tets()) {
    const TissueSet set = set_of(tet.tissue);
    for (const Local x : tet.corners) at_edge_[x] |= set;
  }
}

// Neighbours onto which the topology may let the centre go.
bool Coarsener::list_candidates() {
  candidates_.clear();
  list_tissues();
  interface_.clear();
  if (tissues_.size() > 1) {
    for (const auto& face : star_.gather_faces()) {
      if (star_.tets()[face.tet0].tissue != star_.tets()[face.tet1].tissue) interface_.push_back(face);
    }
    if (!star_.each_tissue_is_one_piece(static_cast<int>(tissues_.size()))) return false;
  }
  const auto all = static_cast<TissueSet>((1u << tissues_.size()) - 1);
  for (Local w = 1; w < star_.vertices().size(); ++w) {
    if (at_edge_[w] != all || (tissues_.size() > 1 && mesh_.is_outer(star_.vertices()[w]))) continue;
    candidates_.push_back({w, 0});
  }
  return !candidates_.empty();
}

bool Coarsener::keeps_sizes(Local w) const {
  if (limits_.sizes == nullptr && limits_.size_at.empty()) return true;
  const Vec3 at = star_.points()[w];
  for (const auto& tet : star_.tets()) {
    if (tet.tissue == 0 || tet.has(w)) continue;
    for (const Local x : tet.corners) {
      if (x == 0) continue;
      const double length2 = norm_squared(star_.points()[x] - at);
      if (limits_.sizes != nullptr) {
        const double size = limits_.sizes->at(tet.tissue, 0.5 * (star_.points()[x] + at));
        if (length2 > size * size) return false;
      }
      if (limits_.size_at.empty()) continue;
      const double size = 0.5 * (limits_.size_at[star_.vertices()[x]] + limits_.size_at[star_.vertices()[w]]);
      if (length2 > size * size) return false;
    }
  }
  return true;
}

// Of the tetrahedra that change; gives up below `enough`.
double Coarsener::worst_slack(Local w, double enough) const {
  double worst = 1;
  const auto& points = star_.points();
  for (const auto& tet : star_.tets()) {
    if (tet.has(w)) continue;
    std::array<Vec3, 4> p;
    for (std::size_t n = 0; n < 4; ++n) p[n] = points[tet.corners[n] == 0 ? w : tet.corners[n]];
    if (tet.tissue == 0) {
      if (!within(kCushionBounds, p[0], p[1], p[2], p[3])) return -2;
      continue;
    }
    worst = std::min(worst, slack(limits_.bounds, p[0], p[1], p[2], p[3]));
    if (worst < enough) return worst;
  }
  return worst;
}

// Link(v) and link(w) may have in common what is in link(vw) only. Of two edges (or faces) that become one, the tissues
// at one must be among those at the other, and be those at the face (or tetrahedron) between them: otherwise interfaces
// would meet that did not, or vanish.
bool Coarsener::keeps_link(Local w) {
  const std::size_t count = star_.vertices().size();
  at_other_edge_.assign(count, 0);
  at_face_.assign(count, 0);
  is_near_other_.assign(count, 0);
  is_in_ring_.assign(count, 0);
  for (const auto& tet : star_.tets()) {
    if (!tet.has(w)) continue;
    for (const Local x : tet.corners) {
      is_in_ring_[x] = 1;
      at_face_[x] |= set_of(tet.tissue);
    }
  }
  const VertexId other = star_.vertices()[w];
  for (const TetId t : mesh_.tets_at(other)) {
    const TissueSet set = set_of(mesh_.tissue(t));
    for (const VertexId x : mesh_.tet(t)) {
      const Local n = star_.local(x);
      if (n == VertexStar::kNone) continue;
      is_near_other_[n] = 1;
      at_other_edge_[n] |= set;
    }
  }
  for (Local x = 1; x < count; ++x) {
    if (x == w || !is_near_other_[x]) continue;
    if (!is_in_ring_[x] || (at_edge_[x] & at_other_edge_[x]) != at_face_[x]) return false;
    if (at_face_[x] != at_edge_[x] && at_face_[x] != at_other_edge_[x]) return false;
  }
  return keeps_edge_link(w) && (tissues_.size() == 1 || keeps_face_link(w));
}

// No edge xy outside of link(vw) with faces to both.
bool Coarsener::keeps_edge_link(Local w) const {
  const auto& tets = star_.tets();
  const auto in_link = [&](Local x, Local y) {
    return std::ranges::any_of(tets, [&](const auto& tet) { return tet.has(w) && tet.has(x) && tet.has(y); });
  };
  const VertexId other = star_.vertices()[w];
  const auto has_face = [&](Local x, Local y) {
    const VertexId a = star_.vertices()[x], b = star_.vertices()[y];
    return std::ranges::any_of(mesh_.tets_at(other), [&](TetId t) {
      const auto& tet = mesh_.tet(t);
      return std::ranges::find(tet, a) != tet.end() && std::ranges::find(tet, b) != tet.end();
    });
  };
  for (const auto& tet : tets) {
    if (tet.has(w)) continue;
    for (const Local x : tet.corners) {
      for (const Local y : tet.corners) {
        if (x == 0 || x >= y || !is_in_ring_[x] || !is_in_ring_[y]) continue;
        if (!in_link(x, y) && has_face(x, y)) return false;
      }
    }
  }
  return true;
}

// Tissue of the tetrahedron at the face wxy that does not have the centre; 0 where there is none.
TissueId Coarsener::tissue_across(Local w, Local x, Local y) const {
  const auto& vertices = star_.vertices();
  for (const TetId t : mesh_.tets_at(vertices[w])) {
    const auto& tet = mesh_.tet(t);
    const auto has = [&](Local n) { return std::ranges::find(tet, vertices[n]) != tet.end(); };
    if (has(x) && has(y) && !has(0)) return mesh_.tissue(t);
  }
  return 0;
}

// A tetrahedron that dies must not be all there is between two interfaces.
bool Coarsener::keeps_face_link(Local w) const {
  for (const auto& dying : star_.tets()) {
    if (!dying.has(w)) continue;
    std::array<Local, 2> xy;
    std::ranges::copy_if(dying.corners, xy.begin(), [w](Local n) { return n != 0 && n != w; });
    const auto beside = std::ranges::find_if(
        star_.tets(), [&](const auto& tet) { return !tet.has(w) && tet.has(xy[0]) && tet.has(xy[1]); });
    if (beside == star_.tets().end() || beside->tissue == dying.tissue) continue;
    if (tissue_across(w, xy[0], xy[1]) != dying.tissue) return false;
  }
  return true;
}

// Interface faces turn a little only, and the centre stays near the planes of all of them.
bool Coarsener::keeps_turns(Local w) const {
  const auto& points = star_.points();
  const Vec3 from = points[0], to = points[w];
  for (const auto& face : interface_) {
    if (face.x == w || face.y == w) continue;
    const Vec3 x = points[face.x], y = points[face.y];
    const Vec3 before = cross(x - from, y - from), after = cross(x - to, y - to);
    const double size = norm(after);
    if (dot(before, after) < limits_.max_turn_cos * norm(before) * size) return false;
    if (std::abs(dot(after, from - to)) > limits_.surface_tolerance_mm * size) return false;
  }
  return true;
}

// The middles of the new interface faces, and of their edges, lie on the boundary.
bool Coarsener::stays_near(Local w) const {
  const auto& points = star_.points();
  for (const auto& face : interface_) {
    if (face.x == w || face.y == w) continue;
    const TissueId a = star_.tets()[face.tet0].tissue, b = star_.tets()[face.tet1].tissue;
    const Vec3 x = points[face.x], y = points[face.y], to = points[w];
    for (const Vec3 p : {(1.0 / 3) * (x + y + to), 0.5 * (x + to), 0.5 * (y + to)}) {
      if (distance_from_boundary(field_, p, a, b) > limits_.surface_tolerance_mm) return false;
    }
  }
  return true;
}

bool Coarsener::visit(VertexId v) {
  if (mesh_.tets_at(v).empty() || mesh_.is_outer(v) || mesh_.tissues_at(v) > 3) return false;
  const bool is_on_interface = mesh_.tissues_at(v) > 1;
  if (is_on_interface && limits_.surface_tolerance_mm <= 0) return false;
  star_.gather(v);
  if (!list_candidates()) return false;
  for (Candidate& c : candidates_)
    c.slack = keeps_sizes(c.vertex) && (!is_on_interface || keeps_turns(c.vertex)) ? worst_slack(c.vertex, 0) : -2;
  std::ranges::stable_sort(candidates_, std::ranges::greater(), &Candidate::slack);
  for (const Candidate& c : candidates_) {
    if (c.slack < kMargin) return false;
    if ((is_on_interface && !stays_near(c.vertex)) || !keeps_link(c.vertex)) continue;
    mesh_.collapse(v, star_.vertices()[c.vertex]);
    return true;
  }
  return false;
}

}  // namespace

std::size_t coarsen(MeshEditor& mesh, const SurfaceField& field, const CoarsenLimits& limits, int rounds,
                    const Stage& stage) {
  constexpr VertexId kPerCheck = 1 << 14;
  constexpr std::size_t kFew = 2000;  // a round that finds one in so many is the last
  Coarsener coarsener(mesh, field, limits);
  std::vector<char> is_due(mesh.vertex_count()), is_touched(mesh.vertex_count());
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) is_due[v] = mesh.changed_at(v) >= limits.since;
  std::size_t gone = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t before = gone;
    std::ranges::fill(is_touched, 0);
    for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
      if (v % kPerCheck == 0) stage.check_cancelled();
      if (!is_due[v] || is_touched[v]) continue;
      if (mesh.tissue_tets() <= limits.target_tets) return gone;
      is_due[v] = 0;
      if (!coarsener.visit(v)) continue;
      ++gone;
      for (const VertexId w : coarsener.touched()) is_due[w] = is_touched[w] = 1;
    }
    if (gone - before <= mesh.vertex_count() / kFew) break;
  }
  return gone;
}

}  // namespace anatomesh
