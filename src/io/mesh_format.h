// The mesh formats, in one table.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// A file format for meshes. Meshes to be written have one label a tetrahedron; files to be read exist and can be
/// opened. Writing is whole or nothing, and the same mesh gives the same bytes.
struct MeshFormat {
  std::string_view extension;                                   ///< with its dot, in small letters
  std::string_view name;                                        ///< for messages and documents
  void (*write)(const std::filesystem::path&, const TetMesh&);  ///< throws IoError, InvalidInput
  TetMesh (*read)(const std::filesystem::path&);                ///< throws IoError, InvalidInput; null: written only
};

/// All of them, the default first.
std::span<const MeshFormat> mesh_formats();

}  // namespace anatomesh
