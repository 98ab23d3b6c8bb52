// The faces between tetrahedra of different tissues.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// A plane in which the original image ends.
struct BorderPlane {
  std::size_t axis;
  double position_mm;  ///< half a voxel past the last voxel centre
};

/// A face between two tissues; (b - a) x (c - a) points from the tissue with the lower number to the other.
struct InterfaceFace {
  std::array<VertexId, 3> vertices;
  TissueId low, high;
  std::optional<BorderPlane> border;  ///< where its tissue ends because the image does
};

Vec3 centroid(const TissueMesh& mesh, const InterfaceFace& face);

/// As long as the face is large (mm^2), from the tissue with the lower number to the other.
Vec3 area_vector(const TissueMesh& mesh, const InterfaceFace& face);

/// All interface faces of a mesh and those at each vertex; stays true while vertices move.
struct InterfaceFaces {
  std::vector<InterfaceFace> faces;
  VertexLists<std::uint32_t> of_vertex;  ///< positions in `faces`, ascending
};

/// A face toward the background lies on the image's border where its tissue goes on to that border around it.
/// Cost: linear. The mesh's tetrahedra are positively oriented.
InterfaceFaces find_interface_faces(const TissueMesh& mesh, const MeshTopology& topology, const TissueImage& image);

}  // namespace anatomesh
