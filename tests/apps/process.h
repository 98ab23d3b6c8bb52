// Runs the program as its users do: a process with arguments, streams and an exit status.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace anatomesh::testing {

/// What a process said and how it ended.
struct ProcessResult {
  int status = -1;  ///< exit status; 128 + the signal's number for one that a signal ended
  std::string out;
  std::string err;
};

/// How to run it.
struct ProcessSettings {
  std::optional<std::uint64_t> max_file_bytes = {};  ///< writing more to a file fails, as on a full disk
  bool without_privileges = false;                   ///< as user nobody where the tests run as root
  std::string interrupt_at = {};  ///< send a signal once the error stream contains this; empty: never
  int interrupt_signal = 0;
};

/// Runs `anatomesh ARGUMENTS` to its end.
ProcessResult run_program(const std::vector<std::string>& arguments, const ProcessSettings& settings = {});

/// A folder of its own for a test, open to every user, removed with all it holds at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  /// Names and contents of all files, also hidden and temporary ones.
  std::map<std::string, std::string> files() const;

 private:
  std::filesystem::path path_;
};

std::string read_file(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace anatomesh::testing
