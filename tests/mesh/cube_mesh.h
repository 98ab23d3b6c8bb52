// Small meshes of whole cubes, for tests of what touches what.
#pragma once

#include <array>
#include <functional>

#include "mesh/tissue_mesh.h"

namespace anatomesh::testing {

/// Unit cubes, each cut into six tetrahedra around its diagonal (Kuhn); tissue_at(i, j, k) is that of a cube.
TissueMesh cube_mesh(std::array<int, 3> cubes, const std::function<int(int i, int j, int k)>& tissue_at);

/// Number of the vertex of cube_mesh() at these coordinates.
VertexId cube_mesh_vertex(std::array<int, 3> cubes, int x, int y, int z);

}  // namespace anatomesh::testing
