// NIfTI-1 and Analyze 7.5 images, read without ITK: ITK 5.2 takes a truncated file for a whole one, aborts the
// process when an sform holds a NaN, uses the sform only where its code is 1, leaves the origin in metres when
// the file is, and needs twice the memory. It still writes these files.
#pragma once

#include <filesystem>

#include "anatomesh/io.h"

namespace anatomesh {

/// As read_label_image(), for a file that is_nifti_file().
ImageFile read_nifti_image(const std::filesystem::path& path);

}  // namespace anatomesh
