// Shape of a quadratic tetrahedron.
#pragma once

#include <array>

#include "anatomesh/types.h"
#include "base/vec.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Corners and edge nodes, in the order of TetMesh::edge_nodes.
struct CurvedTet {
  std::array<Vec3, 4> corners;
  std::array<Vec3, 6> edge_nodes;
};

/// Cosines of the smallest and the largest angle between the tangent planes of two faces, over both ends of all edges.
TetGeometry::CosineRange corner_angles(const CurvedTet& tet);

/// The least Jacobian determinant over that of the straight tetrahedron, not above 1: what its 20 Bezier coefficients
/// (degree 3) allow, so that the true one is this at least. 1: straight; not positive: it may be folded.
double least_jacobian(const CurvedTet& tet);

}  // namespace anatomesh
