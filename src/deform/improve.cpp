#include "deform/improve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/flip_interfaces.h"
#include "deform/improve_shapes.h"
#include "deform/settle.h"
#include "deform/sizes.h"
#include "deform/slide_vertices.h"
#include "mesh/mesh_editor.h"

namespace anatomesh {
namespace {

constexpr int kSmoothings = 2;       // before interface vertices are collapsed
constexpr int kLaterSmoothings = 2;  // after they were
constexpr int kSettleSweeps = 4;
constexpr int kRounds = 10;
constexpr int kToleranceSteps = 3;
constexpr double kEnoughSlack = 0.03;   // tetrahedra with less are worth improving: some 5 degrees above 20
constexpr double kSlidingSlack = 0.02;  // with less, worth moving an interface vertex: some 3 degrees
constexpr double kEarlyMarginDeg = 8;   // collapses that must leave room for smoothing
constexpr double kInterfaceMarginDeg = 2;

// Bounds that are tighter by an angle, as far as the lattice's own angles allow to reach them.
ShapeBounds tightened(const ShapeBounds& bounds, double margin_deg) {
  constexpr double kRadians = std::numbers::pi / 180, kLowestDeg = 30, kHighestDeg = 117;
  const auto degrees = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadians; };
  const double low = degrees(bounds.largest_cos), high = degrees(bounds.smallest_cos);
  return {std::min(bounds.largest_cos, std::cos(std::min(low + margin_deg, kLowestDeg) * kRadians)),
          std::max(bounds.smallest_cos, std::cos(std::max(high - margin_deg, kHighestDeg) * kRadians)),
          bounds.min_mean_ratio};
}

class Improver {
 public:
  Improver(TissueMesh& mesh, const SurfaceField& field, const ShapeBounds& bounds, const ImproveOptions& options,
           VolumeShifts& shifts, const Stage& stage)
      : mesh_(mesh), field_(field), bounds_(bounds), options_(options), shifts_(shifts), stage_(stage) {}

  ImproveReport run();

 private:
  void smooth(int times, double begin, double end);
  void coarsen_early();
  void coarsen_interfaces();
  void coarsen_inside();
  void coarsen_within(MeshEditor& editor, double surface_tolerance_mm, double margin_deg);
  void improve_all(MeshEditor& editor);

  TissueMesh& mesh_;
  const SurfaceField& field_;
  const ShapeBounds& bounds_;
  const ImproveOptions& options_;
  VolumeShifts& shifts_;
  const Stage& stage_;
  ImproveReport report_;
};

void Improver::improve_all(MeshEditor& editor) {
  report_.shape_changes += flip_interfaces(editor, field_, bounds_, stage_);
  report_.shape_changes += improve_shapes(editor, bounds_, kEnoughSlack, stage_);
}

// Bad tetrahedra stop the interfaces that would move; better ones let them.
// Reports its progress from `begin` to `end`.
void Improver::smooth(int times, double begin, double end) {
  for (int n = 0; n < times; ++n) {
    MeshEditor editor(mesh_);
    improve_all(editor);
    mesh_ = editor.result();
    const MeshTopology topology = make_topology(mesh_);
    settle(mesh_, topology, AngleGuard(mesh_, topology, bounds_), field_, kSettleSweeps, shifts_,
           stage_.part("settle", begin + (end - begin) * n / times, begin + (end - begin) * (n + 1) / times));
  }
}

void Improver::coarsen_within(MeshEditor& editor, double surface_tolerance_mm, double margin_deg) {
  CoarsenLimits limits;
  limits.bounds = tightened(bounds_, margin_deg);
  limits.surface_tolerance_mm = surface_tolerance_mm;
  limits.sizes = options_.sizes;
  limits.target_tets = options_.target_tets;
  if (std::isfinite(options_.gradation)) limits.size_at = graded_sizes(editor, options_.gradation);
  report_.collapses += coarsen(editor, field_, limits, kRounds, stage_);
}

// What costs nothing goes before the work is done on it.
void Improver::coarsen_early() {
  MeshEditor editor(mesh_);
  coarsen_within(editor, 0, kEarlyMarginDeg);
  mesh_ = editor.result();
}

// With growing tolerance: what harms least goes first.
void Improver::coarsen_interfaces() {
  constexpr double kFirstVoxels = 0.1, kGrowth = 1.5;
  const Vec3 spacing = field_.image().spacing_mm;
  const double voxel = std::min({spacing.x, spacing.y, spacing.z});
  MeshEditor editor(mesh_);
  for (int step = 1; step <= kToleranceSteps && options_.surface_tolerance_mm > 0; ++step) {
    coarsen_within(editor, options_.surface_tolerance_mm * step / kToleranceSteps, kInterfaceMarginDeg);
    improve_all(editor);
  }
  double tolerance = std::max(options_.surface_tolerance_mm, kFirstVoxels * voxel);
  while (options_.target_tets > 0 && editor.tissue_tets() > options_.target_tets && tolerance <= voxel) {
    coarsen_within(editor, tolerance, 0);
    improve_all(editor);
    tolerance *= kGrowth;
  }
  mesh_ = editor.result();
}

void Improver::coarsen_inside() {
  MeshEditor editor(mesh_);
  if (options_.sizes != nullptr) report_.splits += split_long_edges(editor, bounds_, *options_.sizes, stage_);
  std::uint32_t tried = 0;
  const auto improve_changed = [&] {
    const std::uint32_t now = editor.clock() + 1;
    report_.shape_changes += improve_shapes(editor, bounds_, kEnoughSlack, stage_, tried);
    tried = now;
  };
  for (int n = 0; n < 2; ++n) {
    coarsen_within(editor, 0, 0);
    improve_changed();
  }
  for (int n = 0; n < 2; ++n) {
    report_.shape_changes += slide_vertices(editor, field_, bounds_, kSlidingSlack, stage_);
    improve_changed();
  }
  mesh_ = editor.result();
}

ImproveReport Improver::run() {
  report_.tets_before = tissue_tets(mesh_);
  coarsen_early();
  stage_.at(0.1);
  smooth(kSmoothings, 0.1, 0.5);
  stage_.at(0.5);
  if (options_.surface_tolerance_mm > 0 || options_.target_tets > 0) {
    coarsen_interfaces();
    smooth(kLaterSmoothings, 0.65, 0.8);
  }
  stage_.at(0.8);
  coarsen_inside();
  stage_.at(1);
  report_.tets_after = tissue_tets(mesh_);
  return report_;
}

}  // namespace

ImproveReport improve(TissueMesh& mesh, const SurfaceField& field, const ShapeBounds& bounds,
                      const ImproveOptions& options, VolumeShifts& shifts, const Stage& stage) {
  return Improver(mesh, field, bounds, options, shifts, stage).run();
}

}  // namespace anatomesh
