// Bulk data of Nastran (.bdf), as far as meshes go.
//
// Written: GRID* in large fields, CTETRA, and a PSOLID for each tissue whose number is the label and which asks for the
// material of the same number; vertices and tetrahedra are numbered from 1. A coordinate has 16 characters: about 14
// digits. Comments keep names, and the coordinates that do not fit; other tools see those rounded.
#pragma once

#include <filesystem>
#include <string>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

inline constexpr Label kLargestNastranNumber = 99999999;  // what 8 characters hold

/// Throws IoError, InvalidInput (a label of 0, more points or tetrahedra than there are numbers).
void write_nastran(const std::filesystem::path& path, const TetMesh& mesh);

/// Reads the CTETRA of four corners of a file of any tool, in small, large or free fields, in the order of their
/// numbers; labels are their properties. Throws IoError, InvalidInput (none of them, included files, points in a
/// coordinate system of their own).
TetMesh read_nastran(const std::filesystem::path& path);

/// The number of at most 16 characters that lies next to the value, with the decimal point that Nastran asks for.
std::string nastran_real(double value);

}  // namespace anatomesh
