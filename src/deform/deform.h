// The deformation of the labelled lattice onto the boundaries of the image's tissues.
#pragma once

#include <vector>

#include "anatomesh/options.h"
#include "base/stage.h"
#include "boundary/edge_points.h"
#include "boundary/surface_field.h"
#include "deform/improve.h"
#include "image/tissue_image.h"
#include "mesh/tet_shape.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Those that every tetrahedron of the tissues is to be inside.
ShapeBounds bounds_of(const DeformOptions& options);

/// Deforms lattices over one image in two steps, so that the pipeline can look at the first and refine the lattice
/// where it falls short. Every tetrahedron stays inside the bounds of the options throughout, as those of the lattice
/// are. Holds references to the image and the options, which must outlive it.
class Deformer {
 public:
  /// Finds the image's edge points. Throws Cancelled.
  Deformer(const TissueImage& image, const DeformOptions& options, const Stage& stage);

  /// Takes a lattice to the boundaries, near enough to judge its fidelity: edges that would hold the surface back are
  /// split, the mesh is registered onto the image's edge points (in options.iterations at most) and settled.
  /// The tissues' volumes and surfaces on the lattice stay as they are. Nothing for no iterations. Throws Cancelled.
  void approach(TissueMesh& mesh, const Stage& stage) const;

  /// Smooth and settled surfaces with fewer and better tetrahedra. Throws Cancelled.
  void finish(TissueMesh& mesh, const ImproveOptions& improvement, const Stage& stage) const;

  const SurfaceField& field() const { return field_; }

 private:
  const TissueImage& image_;
  const DeformOptions& options_;
  ShapeBounds bounds_;
  std::vector<Material> materials_;  // one a tissue
  SurfaceField field_;
  std::vector<EdgePoint> targets_;
};

}  // namespace anatomesh
