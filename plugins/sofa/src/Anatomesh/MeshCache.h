// Meshes made earlier, in a folder, each in a file named by what it was made of.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "anatomesh/label_image.h"
#include "anatomesh/options.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh::simulation {

/// 16 hexadecimal digits of the image, of the options that bear on the mesh and of the library's version.
std::string content_hash(const LabelImage& image, const Options& options);

/// Where the mesh of that hash lies in the folder.
std::filesystem::path cached_mesh(const std::filesystem::path& folder, const std::string& hash);

}  // namespace anatomesh::simulation
