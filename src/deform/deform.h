// The deformation of the labelled lattice onto the boundaries of the image's tissues.
#pragma once

#include "anatomesh/options.h"
#include "base/stage.h"
#include "image/tissue_image.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Registers the mesh onto the image's edge points (options.iterations times), then settles it; every tetrahedron stays
/// inside the bounds of the options throughout, as those of the lattice are. Edges that would hold the surface back
/// are split first; the tissues' volumes and surfaces on the lattice stay as they are.
/// Throws Cancelled.
void deform(TissueMesh& mesh, const TissueImage& image, const DeformOptions& options, const Stage& stage);

}  // namespace anatomesh
