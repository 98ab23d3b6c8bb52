// Several output files that appear together or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace anatomesh {

/// What a file is to hold.
struct FileBytes {
  std::filesystem::path target;
  std::string bytes;
};

/// Writes all of them: where one cannot be written or put in its place, every target stays as it was. Throws IoError.
void write_whole_files(const std::vector<FileBytes>& files);

}  // namespace anatomesh
