// Where a point lies against the interfaces of the surface field.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "boundary/surface_field.h"

namespace anatomesh {

/// How far p (mm) is from the boundary of two tissues, to first order, mm. On the border of the original image the
/// boundary to the background is that border.
double distance_from_boundary(const SurfaceField& field, Vec3 p, TissueId a, TissueId b);

/// Whether a tissue is too small for the smoothed shares to show: a ball of eight voxels just keeps its place. Its
/// vertices stay where they are.
inline bool is_tiny(const TissueImage& image, TissueId tissue) { return image.counts[tissue] < 8; }

/// Whether p lies on the border of the original image, to a millionth of a voxel.
bool on_image_border(const TissueImage& image, Vec3 p);

/// The level of the field on which a vertex lies: a surface for two tissues, a line for three, a point for four. It
/// is the boundary itself, or runs beside it where the mesh was settled so.
class InterfaceLevel {
 public:
  /// tissues: those around the vertex; the first eight count. p: mm.
  InterfaceLevel(const SurfaceField& field, Vec3 p, std::span<const TissueId> tissues);

  /// Displacement (mm) that brings q back to the level, to first order; half a voxel at the most.
  Vec3 step_from(Vec3 q) const;

  /// Takes from a displacement at q what leads away from the level, to first order.
  Mat3 along_at(Vec3 q) const;

 private:
  static constexpr std::size_t kMaxTissues = 8;
  using Shares = std::array<double, kMaxTissues>;

  // Each share less their mean, and the gradients of that.
  Shares deviations(Vec3 q, std::array<Vec3, kMaxTissues>& gradients) const;
  // Sum of the gradients' outer products; none far from the boundary, where there is no direction to go.
  std::optional<Mat3> normal_matrix(const std::array<Vec3, kMaxTissues>& gradients) const;

  const SurfaceField& field_;
  std::array<TissueId, kMaxTissues> tissues_;
  std::size_t count_;
  Shares wanted_;
};

}  // namespace anatomesh
