// Models of FEBio (.feb, febio_spec 4.0), as far as meshes go.
//
// Written: Nodes; Elements of type tet4 with a name and a neo-Hookean material for each tissue; a Surface and a NodeSet
// of the same name for each of mesh_surfaces(). Lengths are in mm and stiffnesses in MPa, all the same at first: see
// Material. Comments keep labels and full names. Vertices and tetrahedra are numbered from 1 in the mesh's order.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Throws IoError.
void write_febio(const std::filesystem::path& path, const TetMesh& mesh);

/// Reads the elements of type tet4 of a model of any tool (febio_spec 2.0 to 4.0), in the order of their numbers.
/// Labels come from the comments; without them the parts are numbered from 1 in the order of the file.
/// Throws IoError, InvalidInput (no such elements, a mesh in another file).
TetMesh read_febio(const std::filesystem::path& path);

}  // namespace anatomesh
