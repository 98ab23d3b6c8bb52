// How edges of a mesh would have to bend to follow its surfaces.
#pragma once

#include <vector>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// An edge on a surface or a line where surfaces meet.
struct EdgeBend {
  VertexId from = 0, to = 0;  ///< from < to
  Vec3 bow_mm;                ///< from the middle of the chord, across it, to the surface
};

/// Those edges that bend at all, ascending by from, then to: see quadratic_mesh().
std::vector<EdgeBend> surface_bends(const TetMesh& mesh);

}  // namespace anatomesh
