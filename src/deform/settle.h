// Settling: the last step of the deformation puts every interface vertex on the sub-voxel boundary of its tissues.
#pragma once

#include "base/stage.h"
#include "boundary/label_field.h"
#include "deform/angle_guard.h"

namespace anatomesh {

/// Displacement (mm) that brings a point to where the smoothed shares of its tissues are equal, to first order: a point
/// of the surface between two tissues, of the junction line of three, the meeting point of four.
Vec3 boundary_step(const LabelField& field, Vec3 p, std::span<const TissueId> tissues);

/// Whether the tissues around p lie on the sides where the mesh has them at v: false on the far side of a thin sheet,
/// where stepping to the boundary would turn the sheet inside out.
bool is_on_its_side(const TissueMesh& mesh, const MeshTopology& topology, const LabelField& field, VertexId v, Vec3 p);

/// Relaxes interface vertices along their surface or junction line and puts them on the boundary, under the guard;
/// vertices inside make room. `sweeps` times.
void settle(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const LabelField& field,
            int sweeps, const Stage& stage);

}  // namespace anatomesh
