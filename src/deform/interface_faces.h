// The faces between tetrahedra of different tissues.
#pragma once

#include <array>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// A face between two tissues; (b - a) x (c - a) points from the tissue with the lower number to the other.
struct InterfaceFace {
  std::array<VertexId, 3> vertices;
  TissueId low, high;
};

/// All interface faces of a mesh and those at each vertex; stays true while vertices move.
struct InterfaceFaces {
  std::vector<InterfaceFace> faces;
  VertexLists<std::uint32_t> of_vertex;  ///< positions in `faces`, ascending
};

/// Cost: linear. The mesh's tetrahedra are positively oriented.
InterfaceFaces find_interface_faces(const TissueMesh& mesh, const MeshTopology& topology);

}  // namespace anatomesh
