// Output files that appear complete or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace anatomesh {

/// A file on its way: written under a temporary name in the folder of its target, which it replaces on
/// commit(). Without commit() the temporary file is removed and the target stays as it was.
class OutputFile {
 public:
  /// Throws IoError like check_writable(). Creates the temporary file, empty.
  explicit OutputFile(const std::filesystem::path& target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Where to write; ends with the target's file name, so that its extension is kept.
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Where it will lie: the target, or what it links to.
  const std::filesystem::path& target() const { return target_; }

  /// Makes the bytes its content. Throws IoError.
  void write(std::string_view bytes) const;

  /// Puts the written file in the target's place. Throws IoError.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

/// Writes the bytes to the target, whole or nothing. Throws IoError.
void write_whole_file(const std::filesystem::path& target, std::string_view bytes);

/// Throws IoError unless there is something at path that can be opened and is not empty.
void require_readable(const std::filesystem::path& path);

/// The path in quotation marks, for messages.
std::string in_quotes(const std::filesystem::path& path);

/// The end of a file name from the last dot, in small letters; ".nii.gz" and the like count as one.
std::string file_extension(const std::filesystem::path& path);

}  // namespace anatomesh
