// Where a vertex lies with respect to the boundaries of its tissues.
#pragma once

#include <span>

#include "boundary/surface_field.h"
#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// One step from p towards the place where the shares of the tissues at p are all equal: the boundary of two tissues,
/// the junction line of three, the point of four. At most half a voxel along any axis; zero far from the boundary.
/// Cost: about 0.2 us.
Vec3 boundary_step(const SurfaceField& field, Vec3 p, std::span<const TissueId> tissues);

/// Whether the tissues around p lie on the same sides as they do around v in the mesh. False on the far side of
/// a thin sheet.
bool is_on_its_side(const TissueMesh& mesh, const MeshTopology& topology, const SurfaceField& field, VertexId v,
                    Vec3 p);

}  // namespace anatomesh
