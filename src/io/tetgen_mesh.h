// TetGen's pair of files: points in .node, tetrahedra in .ele, each with its label as its region attribute.
//
// Either stands for both. Comments keep names. Vertices and tetrahedra are numbered from 1.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Writes both files, or neither unless the system fails between the last two renames. Throws IoError.
void write_tetgen(const std::filesystem::path& path, const TetMesh& mesh);

/// Reads both files, of any tool, in the order of their numbers; without region attributes all labels are 1.
/// Throws IoError, InvalidInput (tetrahedra of ten corners, attributes that are no labels).
TetMesh read_tetgen(const std::filesystem::path& path);

}  // namespace anatomesh
