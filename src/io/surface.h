// The surfaces of a mesh as files of triangles have them.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "anatomesh/interfaces.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Triangles between two tissues, or on the skin of one; anticlockwise as seen from outside.
struct SurfacePart {
  Label inside = 0;
  Label outside = 0;  ///< 0: nothing
  std::string name;   ///< letters, digits and _
  std::vector<std::array<VertexId, 3>> triangles;
};

/// Triangles and the vertices that they use, in the order of the mesh's.
struct Surface {
  std::vector<Vec3> points_mm;
  std::vector<SurfacePart> parts;
  LabelTable names;  ///< of the mesh
};

/// All interfaces, each triangle once, seen from the smaller label.
Surface interface_surface(const TetMesh& mesh);

/// The whole surface of each tissue, closed where the mesh is sound. A triangle between two is in both.
std::map<Label, Surface> tissue_surfaces(const TetMesh& mesh);

/// How many triangles it has.
std::size_t triangle_count(const Surface& surface);

/// What names of tissues are in files' names and in groups.
std::map<Label, std::string> tissue_names(const TetMesh& mesh);

}  // namespace anatomesh
