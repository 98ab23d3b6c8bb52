// Better tetrahedra: flips and moves of inner vertices.
#pragma once

#include <cstdint>
#include <span>

#include "base/stage.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Improves the tetrahedra of the tissues whose slack() to the bounds is below `enough`: removes one of their edges or
/// faces (flips 2-3, 3-2, 4-4 and those of more tetrahedra) or moves one of their vertices, inside a tissue, wherever
/// the worst of all tetrahedra concerned gets better. Interfaces stay as they are. Returns the number of changes.
/// Tetrahedra around which nothing has changed since the editor's clock was at `since` are passed over.
/// Of the others, only those with a vertex that is marked in `around`, or newer than it, where it is not empty.
/// Deterministic. Cost: about 10 us a tetrahedron below `enough`.
std::size_t improve_shapes(MeshEditor& mesh, const ShapeBounds& bounds, double enough, const Stage& stage,
                           std::uint32_t since = 0, std::span<const char> around = {});

}  // namespace anatomesh
