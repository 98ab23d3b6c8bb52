// VTK's legacy format, read without VTK, whose reader crashes on damaged files and takes truncated ones for whole.
#pragma once

#include <filesystem>

#include "io/cell_arrays.h"

namespace anatomesh {

/// Reads an unstructured grid of any version up to 5.1, ASCII or binary. Throws IoError.
CellArrays legacy_vtk_cells(const std::filesystem::path& path);

}  // namespace anatomesh
