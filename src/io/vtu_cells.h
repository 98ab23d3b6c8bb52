// VTK's XML format for unstructured grids, read without VTK, whose reader crashes on damaged files.
#pragma once

#include <filesystem>

#include "io/cell_arrays.h"

namespace anatomesh {

/// Reads an unstructured grid: ASCII, base64 or appended, not compressed or with zlib, in one piece or several. Of the
/// arrays of cells, only the one that holds the tissues. Throws IoError, InvalidInput (another compressor).
CellArrays vtu_cells(const std::filesystem::path& path);

}  // namespace anatomesh
