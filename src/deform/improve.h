// The last stage of the deformation: smoother surfaces, fewer and better elements.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "deform/volume_shifts.h"
#include "image/size_field.h"
#include "mesh/tet_shape.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Slack of tetrahedra: those with less are worth improving (some 5 degrees above 20), those with less worth moving an
/// interface vertex (some 3 degrees).
inline constexpr double kEnoughSlack = 0.03, kSlidingSlack = 0.02;

/// By so much the bounds of the first collapses are tighter, which must leave room for smoothing.
inline constexpr double kEarlyMarginDeg = 8;

/// Bounds that are tighter by an angle, as far as the lattice's own angles allow to reach them.
ShapeBounds tightened(const ShapeBounds& bounds, double margin_deg);

/// What may change, and what the elements' sizes should be.
struct ImproveOptions {
  double surface_tolerance_mm = 0;  ///< how far interfaces may move to save elements, >= 0; 0: they keep their vertices
  const SizeField* sizes = nullptr;  ///< the longest edges wanted; null: no limit
  /// How much longer edges may be, a mm farther from the interfaces (mm), >= 0.
  double gradation = std::numeric_limits<double>::infinity();
  /// Tetrahedra wanted, without the cushion: where there are more, interfaces may move farther than the tolerance, the
  /// least harmful first, at most a voxel. 0: as many as the rest gives.
  std::size_t target_tets = 0;
};

/// What has been done.
struct ImproveReport {
  std::size_t tets_before = 0, tets_after = 0;  ///< without the cushion
  std::size_t shape_changes = 0;                ///< flips and moves of single vertices
  std::size_t collapses = 0, splits = 0;
};

/// Improves a mesh that has been settled on the boundary of the field's image: bad tetrahedra are flipped or relaxed
/// and the interfaces, which they held back, settled again; then vertices are collapsed, on interfaces inside the
/// tolerance, inside the tissues as far as the bounds and sizes allow. All tetrahedra of the tissues stay inside the
/// bounds, and the tissues' topology stays as it is. Cushion last, as before. Does not depend on the number of threads.
/// shifts: as for settle(). Throws Cancelled.
ImproveReport improve(TissueMesh& mesh, const SurfaceField& field, const ShapeBounds& bounds,
                      const ImproveOptions& options, VolumeShifts& shifts, const Stage& stage);

}  // namespace anatomesh
