// VTK's own formats for unstructured grids: XML and legacy.
//
// Names and colours of labels lie in the field data: the arrays "label_values" (32-bit), "label_names" (strings) and
// "label_colours" (3 components of 8 bits, where all labels in the table have one), one tuple a label.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// Appended, compressed, 64-bit points. Throws IoError.
void write_vtu(const std::filesystem::path& path, const TetMesh& mesh);
/// Version 4.2, binary, 64-bit points. Throws IoError.
void write_legacy_vtk(const std::filesystem::path& path, const TetMesh& mesh);

/// Throw IoError, InvalidInput: see read_mesh().
TetMesh read_vtu(const std::filesystem::path& path);
TetMesh read_legacy_vtk(const std::filesystem::path& path);

}  // namespace anatomesh
