// Splitting of the inner edges that join two interface vertices.
#pragma once

#include "base/stage.h"
#include "mesh/tet_shape.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// The bounds of a tetrahedron that is well shaped (25 to 135 degrees, mean ratio 0.4) and inside those asked for.
ShapeBounds well_shaped(const ShapeBounds& asked);

/// Splits edges inside a tissue whose two ends lie on interfaces at their midpoints, the longest first, where all new
/// tetrahedra are well shaped and inside the bounds. A tetrahedron with all four vertices on an interface has to go
/// flat when the surface does, so the guard would stop the surface there; afterwards it has a vertex inside that gives
/// way. Tissues' volumes, surfaces and the order of the cushion stay as they are. Cost: a few passes over the
/// tetrahedra.
void split_bridges(TissueMesh& mesh, const ShapeBounds& bounds, const Stage& stage);

}  // namespace anatomesh
