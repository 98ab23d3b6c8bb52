// Quadratic tetrahedra: a node more on every edge, so that elements can be curved.
#pragma once

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Bounds that curved tetrahedra keep, as straight ones do.
struct CurveBounds {
  double min_dihedral_deg = 20;   ///< 0 to 90, between the tangent planes of two faces, at every corner
  double max_dihedral_deg = 150;  ///< 90 to 180
};

/// The mesh with a node on every edge. Those on the surfaces and on the lines where surfaces meet follow their
/// curvature, as the normals at the corners tell it (N. Max, "Weights for Computing Vertex Normals from Facet Normals",
/// J. Graphics Tools 4, 1999: exact on spheres); where surfaces have a sharp edge or end, and inside the tissues, edges
/// stay straight. A node goes only so far that around it all tetrahedra keep the bounds at their corners (or, where the
/// straight one is outside already, become no worse), and that their Jacobian is nowhere below 0.3 of the straight
/// one's. The corners stay as they are. A mesh that is quadratic already gets new edge nodes.
/// Cost: about 2 us a tetrahedron; 100 bytes a tetrahedron meanwhile.
/// Throws InvalidInput unless there is one label a tetrahedron.
TetMesh quadratic_mesh(const TetMesh& mesh, const CurveBounds& bounds = {});

/// The mesh without edge nodes, and without the points that were nothing else.
TetMesh linear_mesh(const TetMesh& mesh);

}  // namespace anatomesh
