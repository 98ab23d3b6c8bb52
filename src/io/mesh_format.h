// The mesh formats, in one table.
#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string_view>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// A file format for meshes. Meshes to be written have one label a tetrahedron, none above the largest; files to be
/// read exist and can be opened. Writing is whole or nothing, and the same mesh gives the same bytes.
struct MeshFormat {
  std::string_view extension;                                             ///< with its dot, in small letters
  std::string_view name;                                                  ///< for messages and documents
  void (*write)(const std::filesystem::path& path, const TetMesh& mesh);  ///< throws IoError, InvalidInput
  /// Throws IoError, InvalidInput; null: surfaces, which hold no tetrahedra to be read.
  TetMesh (*read)(const std::filesystem::path& path);
  Label largest_label = std::numeric_limits<Label>::max();  ///< that the format can hold
  bool keeps_names = true;                                  ///< whether names of labels come back from it
};

/// All of them, the default first.
std::span<const MeshFormat> mesh_formats();

}  // namespace anatomesh
