// Segmented images as the user names them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomesh/io.h"

namespace anatomesh::apps {

/// One label image, or several masks of one grid, labelled 1, 2, 3 ... in their order.
ImageFile read_images(const std::vector<std::filesystem::path>& paths);

/// "'liver.nrrd', 'tumour.nrrd'", for messages.
std::string quoted(const std::vector<std::filesystem::path>& paths);

}  // namespace anatomesh::apps
