// Better tetrahedra at the interfaces: interface vertices slide along the boundary.
#pragma once

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Moves the interface and junction vertices at which a tetrahedron's slack() to the bounds is below `enough` along the
/// boundary of their tissues, to where the worst of their tetrahedra is better; their faces turn by at most 20 degrees,
/// and they end as near to the boundary as they were, or within a twentieth of a voxel. Returns the number of moves.
/// Vertices at which nothing has changed since the editor's clock was at `since` are passed over. Deterministic. Cost:
/// some 20 us for each such vertex. Throws Cancelled.
std::size_t slide_vertices(MeshEditor& mesh, const SurfaceField& field, const ShapeBounds& bounds, double enough,
                           const Stage& stage, std::uint32_t since = 0);

}  // namespace anatomesh
