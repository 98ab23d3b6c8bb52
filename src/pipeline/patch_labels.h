// The tissues of a patch's tetrahedra after a change of the image.
#pragma once

#include <optional>
#include <vector>

#include "base/stage.h"
#include "image/components.h"
#include "image/tissue_image.h"
#include "mesh/tet_shape.h"
#include "pipeline/mesh_patch.h"

namespace anatomesh {

/// Gives the tetrahedra that changed voxels reach the tissue that most points inside them have in the smoothed image.
/// is_changed: by voxel of `part`, a box of the image. Background that is outside the bounds stays background.
/// Returns by tetrahedron whether it was asked.
std::vector<char> vote(TissueMesh& mesh, const TissueImage& part, const std::vector<char>& is_changed,
                       const ShapeBounds& bounds);

/// What mending labels takes.
struct LabelMending {
  const TissueImage& image;            ///< all of it
  const ImageComponents& components;   ///< of the image
  const TissueImage& part;             ///< a box of it around the patch
  const RestPieces& rest;              ///< of the patch's border vertices
  const std::vector<Vec3>& border_mm;  ///< where those are, by vertex of the patch as it was taken
  const std::vector<int>& pieces_off;  ///< by tissue: by how many its pieces may be off
  ShapeBounds bounds;
};

/// What could not be mended; nothing where all was.
struct MendFailure {
  std::vector<Vec3> singular_mm;  ///< where surfaces stay singular
  std::vector<char> miscounted;   ///< by tissue: whether it has another number of pieces
};

/// Makes the surfaces of all tissues manifold and the pieces of each tissue as many as the image has components, by
/// relabelling tetrahedra away from the border, and by splitting edges where that takes smaller ones. Throws Cancelled.
std::optional<MendFailure> mend_labels(TissueMesh& mesh, const LabelMending& mending, const Stage& stage);

}  // namespace anatomesh
