// The surfaces of a mesh: where two tissues meet, and the outer skin.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// A face of a tetrahedron: the one that lies opposite to a corner (0 to 3).
struct TetFace {
  TetId tet = 0;
  std::uint8_t opposite = 0;
  bool operator==(const TetFace&) const = default;
};

/// The faces between the tetrahedra of two labels, or between one label and the outside.
struct Interface {
  Label inside = 0;            ///< the smaller label; the faces are those of its tetrahedra
  Label outside = 0;           ///< the larger one; 0: nothing, the faces lie on the skin
  std::vector<TetFace> faces;  ///< by ascending tetrahedron
};

/// Vertices of a face, anticlockwise as seen from outside its tetrahedron.
std::array<VertexId, 3> corners_of(const TetMesh& mesh, TetFace face);

/// Edge nodes of a face of a quadratic tetrahedron: the first between the first two of corners_of(), and so on round.
std::array<VertexId, 3> edge_nodes_of(const TetMesh& mesh, TetFace face);

/// All interfaces, each face once, sorted by inside, then outside. A tetrahedron labelled 0 counts as any other. A
/// face of more than two tetrahedra, which no sound mesh has, lies on the skin of each. Cost: sorting the faces, about
/// 0.3 us a tetrahedron; 64 bytes a tetrahedron meanwhile.
/// Throws InvalidInput unless there is one label a tetrahedron.
std::vector<Interface> interfaces_of(const TetMesh& mesh);

}  // namespace anatomesh
