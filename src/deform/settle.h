// Settling: the last step of the deformation lays the interfaces smoothly along the sub-voxel boundaries of their
// tissues.
#pragma once

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "deform/angle_guard.h"
#include "deform/volume_shifts.h"

namespace anatomesh {

/// Moves interface vertices so that the faces around them straddle the boundary of their two tissues and lie along it,
/// and evenly along their surface or junction line, under the guard; vertices inside make room. `sweeps`
/// times; fewer do where the mesh lies near the boundary already. Faces at the border of the original image go onto
/// that border. Vertices of tissues of fewer than eight voxels stay. shifts: of the boundaries, for the sake of the
/// volumes; brought up to date, and carried from call to call.
void settle(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
            int sweeps, VolumeShifts& shifts, const Stage& stage);

}  // namespace anatomesh
