// VTK's own formats for unstructured grids: XML and legacy.
//
// Names and colours of labels lie in the field data: the arrays "label_values" (32-bit) and "label_colours" (3
// components of 8 bits, where all labels in the table have one), one tuple a label, and "label_names": the names in
// UTF-8, each with a zero behind it, as 8-bit numbers. VTK's arrays of strings are read as well, but not written:
// meshio refuses files that have one.
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
