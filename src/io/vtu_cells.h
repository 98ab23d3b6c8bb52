// VTK's XML format for unstructured grids.
#pragma once

#include <filesystem>

#include "io/cell_arrays.h"

namespace anatomesh {

/// Reads an unstructured grid through VTK. Throws IoError.
CellArrays vtu_cells(const std::filesystem::path& path);

}  // namespace anatomesh
