#include "deform/improve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/improve_shapes.h"
#include "deform/settle.h"
#include "deform/sizes.h"
#include "mesh/mesh_editor.h"

namespace anatomesh {
namespace {

constexpr int kSmoothings = 3;       // before anything is collapsed
constexpr int kLaterSmoothings = 2;  // after interface vertices were
constexpr int kSettleSweeps = 4;
constexpr int kRounds = 10;
constexpr double kEnoughSlack = 0.05;  // tetrahedra with less are worth improving: some 8 degrees above 20

class Improver {
 public:
  Improver(TissueMesh& mesh, const LabelField& field, const ShapeBounds& bounds, const ImproveOptions& options,
           const Stage& stage)
      : mesh_(mesh), field_(field), bounds_(bounds), options_(options), stage_(stage) {}

  ImproveReport run();

 private:
  void smooth(int times);
  void coarsen_interfaces();
  void coarsen_inside();
  CoarsenLimits limits(const MeshEditor& editor) const;

  TissueMesh& mesh_;
  const LabelField& field_;
  const ShapeBounds& bounds_;
  const ImproveOptions& options_;
  const Stage& stage_;
  ImproveReport report_;
};

// Bad tetrahedra stop the interfaces that would move; better ones let them.
void Improver::smooth(int times) {
  for (int n = 0; n < times; ++n) {
    MeshEditor editor(mesh_);
    report_.shape_changes += improve_shapes(editor, bounds_, kEnoughSlack, stage_);
    mesh_ = editor.result();
    const MeshTopology topology = make_topology(mesh_);
    settle(mesh_, topology, AngleGuard(mesh_, topology, bounds_), field_, kSettleSweeps, stage_.part("settle", 0, 1));
  }
}

CoarsenLimits Improver::limits(const MeshEditor& editor) const {
  CoarsenLimits limits;
  limits.bounds = bounds_;
  limits.size_mm = options_.size_mm;
  limits.target_tets = options_.target_tets;
  if (std::isfinite(options_.gradation)) limits.size_at = graded_sizes(editor, options_.gradation);
  return limits;
}

// With growing tolerance: what harms least goes first.
void Improver::coarsen_interfaces() {
  constexpr int kSteps = 4;
  MeshEditor editor(mesh_);
  CoarsenLimits limits = this->limits(editor);
  for (int step = 1; step <= kSteps; ++step) {
    limits.surface_tolerance_mm = options_.surface_tolerance_mm * step / kSteps;
    report_.collapses += coarsen(editor, field_, limits, kRounds, stage_);
  }
  mesh_ = editor.result();
}

void Improver::coarsen_inside() {
  MeshEditor editor(mesh_);
  if (!options_.size_mm.empty()) report_.splits += split_long_edges(editor, bounds_, options_.size_mm, stage_);
  const CoarsenLimits limits = this->limits(editor);
  for (int n = 0; n < 2; ++n) {
    report_.collapses += coarsen(editor, field_, limits, kRounds, stage_);
    report_.shape_changes += improve_shapes(editor, bounds_, kEnoughSlack, stage_);
  }
  mesh_ = editor.result();
}

ImproveReport Improver::run() {
  const auto tissue_tets = [&] {
    return mesh_.tissues.size() - static_cast<std::size_t>(std::ranges::count(mesh_.tissues, TissueId{0}));
  };
  report_.tets_before = tissue_tets();
  smooth(kSmoothings);
  stage_.at(0.5);
  if (options_.surface_tolerance_mm > 0) {
    coarsen_interfaces();
    smooth(kLaterSmoothings);
  }
  stage_.at(0.8);
  coarsen_inside();
  report_.tets_after = tissue_tets();
  return report_;
}

}  // namespace

ImproveReport improve(TissueMesh& mesh, const LabelField& field, const ShapeBounds& bounds,
                      const ImproveOptions& options, const Stage& stage) {
  return Improver(mesh, field, bounds, options, stage).run();
}

}  // namespace anatomesh
