// Real segmented images for tests, as far as this machine has them. A test skips what is not there.
#pragma once

#include <filesystem>
#include <vector>

namespace anatomesh::testing {

/// Images of the folder $ANATOMESH_SHARED_DATA, or else of ../shared/data beside the source tree; by name.
/// Empty when there is no such folder.
std::vector<std::filesystem::path> shared_images();

/// The nine label images of Debian's package mricron-data that are installed.
std::vector<std::filesystem::path> mricron_images();

/// Path of one of the images above by file name; empty when it is not there.
std::filesystem::path find_image(const std::filesystem::path& file_name);

}  // namespace anatomesh::testing
