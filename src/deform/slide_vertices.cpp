#include "deform/slide_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "boundary/interface_level.h"
#include "deform/search_directions.h"
#include "mesh/star_slack.h"
#include "mesh/vertex_star.h"

namespace anatomesh {
namespace {

constexpr double kGain = 1e-3;        // of slack
constexpr double kMaxTurnCos = 0.94;  // of an interface face
constexpr double kNearVoxels = 0.05;  // from the level on which a vertex slides

class Slider {
 public:
  Slider(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds)
      : mesh_(mesh), field_(field), bounds_(bounds), star_(mesh) {
    const Vec3 voxel = field.image().spacing_mm;
    near_mm_ = kNearVoxels * std::min({voxel.x, voxel.y, voxel.z});
  }

  bool visit(VertexId v, double enough);

 private:
  void measure(VertexId v);
  void gather(VertexId v);
  bool keeps_faces(Vec3 p) const;
  double shortest_edge() const;

  MeshEditor& mesh_;
  const SurfaceField& field_;
  const ShapeBounds& bounds_;
  VertexStar star_;
  StarSlack slack_;
  double near_mm_;
  std::vector<TissueId> tissues_;
  std::vector<VertexStar::Face> interface_;
};

void Slider::measure(VertexId v) {
  slack_.start(bounds_, mesh_.point(v));
  for (const TetId t : mesh_.tets_at(v)) {
    const auto [b, c, d] = corners_after(mesh_.tet(t), v);
    slack_.add(mesh_.point(b), mesh_.point(c), mesh_.point(d), mesh_.tissue(t) == 0);
  }
  slack_.close();
}

void Slider::gather(VertexId v) {
  star_.gather(v);
  tissues_.clear();
  for (const auto& tet : star_.tets()) tissues_.push_back(tet.tissue);
  sort_and_unify(tissues_);
}

bool Slider::keeps_faces(Vec3 p) const {
  const Vec3 from = star_.points()[0];
  return std::ranges::all_of(interface_, [&](const VertexStar::Face& face) {
    const Vec3 x = star_.points()[face.x], y = star_.points()[face.y];
    const Vec3 before = cross(x - from, y - from), after = cross(x - p, y - p);
    return dot(before, after) >= kMaxTurnCos * std::sqrt(norm_squared(before) * norm_squared(after));
  });
}

double Slider::shortest_edge() const {
  double shortest2 = norm_squared(star_.points()[1] - star_.points()[0]);
  for (std::size_t n = 2; n < star_.points().size(); ++n)
    shortest2 = std::min(shortest2, norm_squared(star_.points()[n] - star_.points()[0]));
  return std::sqrt(shortest2);
}

bool Slider::visit(VertexId v, double enough) {
  measure(v);
  Vec3 at = mesh_.point(v);
  const double before = slack_.at(at, -2);
  if (before >= enough) return false;
  gather(v);
  if (std::ranges::any_of(tissues_, [&](TissueId t) { return is_tiny(field_.image(), t); })) return false;
  if (on_image_border(field_.image(), at)) return false;
  interface_.clear();
  for (const auto& face : star_.gather_faces()) {
    if (star_.tets()[face.tet0].tissue != star_.tets()[face.tet1].tissue) interface_.push_back(face);
  }
  const InterfaceLevel level(field_, at, tissues_);
  double best = before, step = 0.3 * shortest_edge();
  for (int n = 0; n < 4; ++n, step *= 0.5) {
    const Vec3 around = at;
    const Mat3 along = level.along_at(around);
    for (const Vec3 direction : kSearchDirections) {
      // Most places are no better even before they are brought to the level exactly.
      Vec3 p = around + step * (along * direction);
      if (slack_.at(p, best + kGain) <= best + kGain) continue;
      for (int k = 0; k < 2; ++k) p += level.step_from(p);
      const double there = slack_.at(p, best + kGain);
      if (there <= best + kGain || norm(level.step_from(p)) > near_mm_ || !keeps_faces(p)) continue;
      best = there;
      at = p;
    }
  }
  if (best <= before) return false;
  mesh_.move(v, at);
  return true;
}

}  // namespace

std::size_t slide_vertices(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds, double enough,
                           const Stage& stage, std::uint32_t since) {
  constexpr VertexId kPerCheck = 1 << 14;
  Slider slider(mesh, field, bounds);
  std::size_t moves = 0;
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) {
    if (v % kPerCheck == 0) stage.check_cancelled();
    if (mesh.tissues_at(v) < 2 || mesh.is_outer(v) || mesh.changed_at(v) < since) continue;
    moves += slider.visit(v, enough);
  }
  return moves;
}

}  // namespace anatomesh
