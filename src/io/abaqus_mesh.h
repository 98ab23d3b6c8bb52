// Input files of Abaqus and CalculiX (.inp), as far as meshes go.
//
// Written: *NODE; an *ELEMENT, TYPE=C3D4 block with an ELSET for each tissue; a *SURFACE, TYPE=ELEMENT and a *NSET of
// the same name for each of mesh_surfaces(); nothing but the mesh, so that a deck can *INCLUDE it. Comments keep labels
// and full names. Vertices and tetrahedra are numbered from 1 in the mesh's order, to which reading returns.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Throws IoError.
void write_abaqus(const std::filesystem::path& path, const TetMesh& mesh);

/// Reads the C3D4 elements of a file of any tool, in the order of their numbers. Labels come from the comments. Without
/// them, the element sets that *SOLID SECTION names, else all element sets, are numbered from 1 in the order of the
/// file; an element of several sets belongs to the smallest, those of none get the next number.
/// Throws IoError, InvalidInput (no C3D4 elements, included files, moved or turned parts).
TetMesh read_abaqus(const std::filesystem::path& path);

}  // namespace anatomesh
