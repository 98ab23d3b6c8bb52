// Settling: the last step of the deformation lays the interfaces smoothly along the sub-voxel boundaries of their tissues.
#pragma once

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "deform/angle_guard.h"

namespace anatomesh {

void settle(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
            int sweeps, const Stage& stage);

}  // namespace anatomesh
