// Files of surfaces, which are only written.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// All interfaces of the mesh, each triangle once. Throw IoError.
void write_stl(const std::filesystem::path& path, const TetMesh& mesh);
void write_ply(const std::filesystem::path& path, const TetMesh& mesh);
void write_obj(const std::filesystem::path& path, const TetMesh& mesh);
void write_vtp(const std::filesystem::path& path, const TetMesh& mesh);

}  // namespace anatomesh
