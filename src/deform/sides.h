// On which sides of a vertex its tissues lie.
#pragma once

#include "boundary/surface_field.h"
#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Whether the tissues around p lie on the sides where the mesh has them at v: false on the far side of a thin sheet,
/// where a vertex would turn the sheet inside out.
bool is_on_its_side(const TissueMesh& mesh, const MeshTopology& topology, const SurfaceField& field, VertexId v,
                    Vec3 p);

}  // namespace anatomesh
