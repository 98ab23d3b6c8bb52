// Small tetrahedral meshes that tests of several floors share.
#pragma once

#include <array>

#include "anatomesh/tet_mesh.h"

namespace anatomesh::testing {

/// One tetrahedron of label 1.
TetMesh single_tet(const std::array<Vec3, 4>& corners);

/// The one at the origin, with edges of 1 mm along the axes.
TetMesh corner_tet();

/// corner_tet() and one beyond its slanted face, with points whose coordinates are whole.
TetMesh two_tets(Label first, Label second);

/// The same tetrahedra, with points that take all digits of a number.
TetMesh two_uneven_tets(Label first, Label second);

}  // namespace anatomesh::testing
