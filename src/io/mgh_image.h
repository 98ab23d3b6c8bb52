// FreeSurfer's volumes: .mgh, and .mgz, the same compressed with gzip.
#pragma once

#include <filesystem>

#include "anatomesh/io.h"

namespace anatomesh {

/// Whether the extension is one of theirs.
bool is_mgh_file(const std::filesystem::path& path);

/// As read_label_image(), for a file that is_mgh_file().
ImageFile read_mgh_image(const std::filesystem::path& path);

}  // namespace anatomesh
