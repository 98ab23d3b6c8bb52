// The format of MEDIT, .mesh, which Mmg, TetGen and many others read and write.
//
// Written is version 2 (64-bit numbers), ASCII. A tetrahedron's reference is its label; the triangles are those of all
// interfaces and of the outer skin, with a reference for each. What references stand for is said in comments:
// "# label 17 White matter", which are read back, and "# surface 120 White matter_skin".
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Throws IoError.
void write_medit(const std::filesystem::path& path, const TetMesh& mesh);

/// ASCII files of any version, of any tool; all but vertices and tetrahedra is passed over. Throws IoError,
/// InvalidInput: see read_mesh().
TetMesh read_medit(const std::filesystem::path& path);

}  // namespace anatomesh
