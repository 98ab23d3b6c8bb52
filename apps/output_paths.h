// Output files, looked at before the work starts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace anatomesh::apps {

/// Throws IoError unless a mesh can be written there, InvalidOption where no format has the extension.
void require_mesh_output(const std::filesystem::path& path);

/// The same for a file each of the surfaces of tissues.
void require_surface_output(const std::filesystem::path& path);

/// Throws IoError unless a text file can be written there; an empty path stands for no file.
void require_text_output(const std::filesystem::path& path);

/// Throws InvalidOption where two of the paths, empty ones aside, are the same file, also by way of links.
void require_different_files(const std::vector<std::filesystem::path>& paths);

/// Bytes of a file; 0 where it is none, as a device.
std::uintmax_t size_on_disk(const std::filesystem::path& path);

}  // namespace anatomesh::apps
