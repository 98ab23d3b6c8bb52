// Surfaces as the bytes of files, one function a format.
#pragma once

#include <string>

#include "io/surface.h"

namespace anatomesh {

/// Binary, with normals; 32-bit points, as STL has no others, and no labels.
std::string stl_bytes(const Surface& surface);

/// Binary, 64-bit points; the properties "label" and "label_outside" a face, and the colour of the inside where all
/// labels have one.
std::string ply_bytes(const Surface& surface);

/// Text; one group a part.
std::string obj_bytes(const Surface& surface);

/// Appended, compressed, 64-bit points; the cell arrays "label" and "label_outside", and the label table as in .vtu
/// files. Throws IoError where VTK fails.
std::string vtp_bytes(const Surface& surface);

}  // namespace anatomesh
