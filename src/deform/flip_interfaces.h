// Flips of interface edges.
#pragma once

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Replaces edges ab of the interface of two tissues, between the faces abc and abd, by the edge cd where the faces are
/// nearly in one plane and that makes the interface smoother (the angles at the five edges concerned smaller on the
/// whole) or the worst of the tetrahedra there better, and neither much worse. The tetrahedra on both sides are filled
/// anew inside the bounds. Topology and vertices stay. Returns the number of flips. Edges at which nothing has
/// changed since the editor's clock was at `since` are passed over. Deterministic. Cost: about 2 us an interface edge.
/// Throws Cancelled.
std::size_t flip_interfaces(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds, const Stage& stage,
                            std::uint32_t since = 0);

}  // namespace anatomesh
