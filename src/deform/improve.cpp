#include "deform/improve.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <vector>

#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/flip_interfaces.h"
#include "deform/improve_shapes.h"
#include "deform/settle.h"
#include "deform/sizes.h"
#include "deform/slide_vertices.h"
#include "mesh/edit_in_blocks.h"
#include "mesh/mesh_editor.h"

namespace anatomesh {
namespace {

constexpr int kSmoothings = 2;       // before interface vertices are collapsed
constexpr int kLaterSmoothings = 2;  // after they were
constexpr int kSettleSweeps = 3;
constexpr int kRounds = 10;
constexpr int kToleranceSteps = 3;
constexpr double kInterfaceMarginDeg = 2;
// Blocks to be worked on at once: so many at least, of so many tetrahedra.
constexpr std::size_t kBlocks = 8, kLeast = 1 << 13, kMost = 1 << 16;
constexpr std::array<std::array<double, 2>, 3> kShares = {{{0.5, 0.35}, {0.42, 0.6}, {0.46, 0.32}}};

class Improver {
 public:
  Improver(TissueMesh& mesh, const SurfaceField& field, const ShapeBounds& bounds, const ImproveOptions& options,
           VolumeShifts& shifts, const Stage& stage)
      : mesh_(mesh), field_(field), bounds_(bounds), options_(options), shifts_(shifts), stage_(stage) {}

  ImproveReport run();

 private:
  // A block of the mesh under work. What has been tried on it since `since` is not tried again.
  struct Work {
    MeshEditor& editor;
    std::span<const VertexId> vertices;
    std::uint32_t since;
  };
  void in_blocks(std::span<const double> shares, const std::function<void(Work)>& edit);
  CoarsenLimits limits_within(double surface_tolerance_mm, double margin_deg, std::uint32_t since) const;
  void coarsen_with(const Work& work, CoarsenLimits limits);
  void improve_all(const Work& work);
  void smooth(int times, bool coarsen_first, double begin, double end);
  void coarsen_interfaces();
  void split_edges();
  void coarsen_inside();

  TissueMesh& mesh_;
  const SurfaceField& field_;
  const ShapeBounds& bounds_;
  const ImproveOptions& options_;
  VolumeShifts& shifts_;
  const Stage& stage_;
  std::vector<double> graded_;  // by vertex of the mesh: wanted sizes for the gradation
  ImproveReport report_;
  std::atomic<std::size_t> shape_changes_ = 0, collapses_ = 0;
};

// Cut in one way after the other, so that what lies at a seam at first lies inside a block later. What is left then is
// tried again the next time only.
void Improver::in_blocks(std::span<const double> shares, const std::function<void(Work)>& edit) {
  if (std::isfinite(options_.gradation)) graded_ = graded_sizes(MeshEditor(mesh_), options_.gradation);
  // A number of tetrahedra is kept by one that knows them all.
  const std::size_t most =
      options_.target_tets > 0 ? mesh_.tets.size() : std::clamp(mesh_.tets.size() / kBlocks, kLeast, kMost);
  std::vector<char> is_due(mesh_.points_mm.size(), 1);
  for (const double share : shares) {
    mesh_ = edit_in_blocks(mesh_, {most, share}, is_due, [&](MeshEditor& editor, std::span<const VertexId> vertices) {
      edit({editor, vertices, 1});
    });
    if (mesh_.tets.size() <= most) break;
  }
  mesh_ = with_cushion_last(mesh_);
}

CoarsenLimits Improver::limits_within(double surface_tolerance_mm, double margin_deg, std::uint32_t since) const {
  CoarsenLimits limits;
  limits.bounds = tightened(bounds_, margin_deg);
  limits.surface_tolerance_mm = surface_tolerance_mm;
  limits.sizes = options_.sizes;
  limits.target_tets = options_.target_tets;
  limits.since = since;
  return limits;
}

void Improver::coarsen_with(const Work& work, CoarsenLimits limits) {
  if (!graded_.empty()) {
    for (const VertexId v : work.vertices) limits.size_at.push_back(graded_[v]);
  }
  collapses_ += coarsen(work.editor, field_, limits, kRounds, stage_);
}

void Improver::improve_all(const Work& work) {
  shape_changes_ += flip_interfaces(work.editor, field_, bounds_, stage_, work.since);
  shape_changes_ += improve_shapes(work.editor, bounds_, kEnoughSlack, stage_, work.since);
}

// Bad tetrahedra stop the interfaces that would move; better ones let them. What costs nothing goes before the work is
// done on it. Reports its progress from `begin` to `end`.
void Improver::smooth(int times, bool coarsen_first, double begin, double end) {
  for (int n = 0; n < times; ++n) {
    in_blocks(kShares[static_cast<std::size_t>(n) % kShares.size()], [&](const Work& work) {
      if (coarsen_first && n == 0) coarsen_with(work, limits_within(0, kEarlyMarginDeg, work.since));
      improve_all(work);
    });
    const MeshTopology topology = make_topology(mesh_);
    settle(mesh_, topology, AngleGuard(mesh_, topology, bounds_), field_, kSettleSweeps, shifts_,
           stage_.part("settle", begin + (end - begin) * n / times, begin + (end - begin) * (n + 1) / times));
  }
}

// With growing tolerance: what harms least goes first.
void Improver::coarsen_interfaces() {
  constexpr double kFirstVoxels = 0.1, kGrowth = 1.5;
  const Vec3 spacing = field_.image().spacing_mm;
  const double voxel = std::min({spacing.x, spacing.y, spacing.z});
  const auto thin_out = [&](double tolerance_mm, double margin_deg) {
    in_blocks(kShares.front(), [&](const Work& work) {
      coarsen_with(work, limits_within(tolerance_mm, margin_deg, work.since));
      improve_all(work);
    });
  };
  for (int step = 1; step <= kToleranceSteps && options_.surface_tolerance_mm > 0; ++step)
    thin_out(options_.surface_tolerance_mm * step / kToleranceSteps, kInterfaceMarginDeg);
  double tolerance = std::max(options_.surface_tolerance_mm, kFirstVoxels * voxel);
  while (options_.target_tets > 0 && tissue_tets(mesh_) > options_.target_tets && tolerance <= voxel) {
    thin_out(tolerance, 0);
    tolerance *= kGrowth;
  }
}

void Improver::split_edges() {
  MeshEditor editor(mesh_);
  report_.splits = split_long_edges(editor, bounds_, *options_.sizes, stage_);
  mesh_ = editor.result();
}

void Improver::coarsen_inside() {
  in_blocks(kShares.back(), [&](const Work& work) {
    MeshEditor& editor = work.editor;
    std::uint32_t coarsened = work.since, improved = work.since, slid = work.since;
    const auto improve_changed = [&] {
      const std::uint32_t now = editor.clock() + 1;
      shape_changes_ += improve_shapes(editor, bounds_, kEnoughSlack, stage_, improved);
      improved = now;
    };
    for (int n = 0; n < 2; ++n) {
      const std::uint32_t now = editor.clock() + 1;
      coarsen_with(work, limits_within(0, 0, coarsened));
      coarsened = now;
      improve_changed();
    }
    for (int n = 0; n < 2; ++n) {
      const std::uint32_t now = editor.clock() + 1;
      shape_changes_ += slide_vertices(editor, field_, bounds_, kSlidingSlack, stage_, slid);
      slid = now;
      improve_changed();
    }
  });
}

ImproveReport Improver::run() {
  report_.tets_before = tissue_tets(mesh_);
  smooth(kSmoothings, true, 0, 0.5);
  if (options_.surface_tolerance_mm > 0 || options_.target_tets > 0) {
    coarsen_interfaces();
    smooth(kLaterSmoothings, false, 0.65, 0.8);
  }
  stage_.at(0.8);
  if (options_.sizes != nullptr) split_edges();
  coarsen_inside();
  stage_.at(1);
  report_.tets_after = tissue_tets(mesh_);
  report_.shape_changes = shape_changes_;
  report_.collapses = collapses_;
  return report_;
}

}  // namespace

ShapeBounds tightened(const ShapeBounds& bounds, double margin_deg) {
  constexpr double kRadians = std::numbers::pi / 180, kLowestDeg = 30, kHighestDeg = 117;
  const auto degrees = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) / kRadians; };
  const double low = degrees(bounds.largest_cos), high = degrees(bounds.smallest_cos);
  return {std::min(bounds.largest_cos, std::cos(std::min(low + margin_deg, kLowestDeg) * kRadians)),
          std::max(bounds.smallest_cos, std::cos(std::max(high - margin_deg, kHighestDeg) * kRadians)),
          bounds.min_mean_ratio};
}

ImproveReport improve(TissueMesh& mesh, const SurfaceField& field, const ShapeBounds& bounds,
                      const ImproveOptions& options, VolumeShifts& shifts, const Stage& stage) {
  return Improver(mesh, field, bounds, options, shifts, stage).run();
}

}  // namespace anatomesh
