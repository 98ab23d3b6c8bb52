// Output files, looked at before the work starts.
#pragma once

#include <filesystem>

namespace anatomesh::apps {

/// Throws IoError unless a mesh can be written there, InvalidOption where no format has the extension.
void require_mesh_output(const std::filesystem::path& path);

/// Throws IoError unless a text file can be written there; an empty path stands for no file.
void require_text_output(const std::filesystem::path& path);

}  // namespace anatomesh::apps
