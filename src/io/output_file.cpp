#include "io/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <system_error>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

constexpr mode_t kNewFileMode = 0666;  // less the user's umask, as for any new file

std::string reason(int error_number) { return std::generic_category().message(error_number); }

[[noreturn]] void throw_cannot_write(const fs::path& path, const std::string& why) {
  throw IoError("cannot write " + in_quotes(path) + ": " + why);
}

/// A file descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC, kNewFileMode)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  bool is_open() const { return number_ >= 0; }
  int number() const { return number_; }

  /// Closes now; false where the system reports a late write error.
  bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

/// Writes all bytes; returns 0 or the error number.
int write_all(Descriptor& file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return file.close() ? 0 : errno;
}

/// The target is for messages.
void write_bytes(const fs::path& path, std::string_view bytes, const fs::path& target) {
  Descriptor file(path, O_WRONLY | O_TRUNC);
  const int error_number = file.is_open() ? write_all(file, bytes) : errno;
  if (error_number != 0) throw_cannot_write(target, reason(error_number));
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// Where the bytes will lie: the end of a chain of symbolic links, so that links stay links.
fs::path resolved(const fs::path& path) {
  std::error_code none;
  const fs::path real = fs::weakly_canonical(path, none);
  return none || real.empty() ? path : real;
}

/// A device such as a terminal or /dev/null, or the process's own standard output wherever it goes.
bool is_stream(const fs::path& path) {
  std::error_code none;
  return fs::is_character_file(path, none) || path == "/dev/stdout";
}

fs::path unused_name_beside(const fs::path& target) {
  static std::atomic<unsigned> count = 0;
  const std::string tag = std::to_string(::getpid()) + "-" + std::to_string(count++);
  return folder_of(target) / (".part-" + tag + "-" + target.filename().string());
}

}  // namespace

OutputFile::OutputFile(const fs::path& target) : target_(resolved(target)), temporary_(unused_name_beside(target_)) {
  check_writable(target);
  const Descriptor file(temporary_, O_WRONLY | O_CREAT | O_EXCL);
  if (!file.is_open()) throw_cannot_write(target_, reason(errno));
}

OutputFile::~OutputFile() {
  if (temporary_.empty()) return;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void OutputFile::write(std::string_view bytes) const { write_bytes(temporary_, bytes, target_); }

void OutputFile::commit() {
  std::error_code failure;
  fs::rename(temporary_, target_, failure);
  if (failure) throw_cannot_write(target_, failure.message());
  temporary_.clear();
}

void write_whole_file(const fs::path& target, std::string_view bytes) {
  if (is_stream(target)) return write_bytes(target, bytes, target);
  OutputFile file(target);
  file.write(bytes);
  file.commit();
}

void write_text_file(const fs::path& path, std::string_view text) { write_whole_file(path, text); }

void check_writable(const fs::path& path) {
  if (!path.has_filename()) throw_cannot_write(path, "a file name is needed");
  std::error_code none;
  if (fs::is_directory(path, none)) throw_cannot_write(path, "it is a folder; name a file in it");
  if (is_stream(path)) return;
  if (fs::is_other(path, none)) throw_cannot_write(path, "it is a pipe or the like; name a file");
  const fs::path folder = folder_of(resolved(path));
  if (!fs::exists(folder, none))
    throw_cannot_write(path, "there is no folder " + in_quotes(folder) + "; create it first");
  if (!fs::is_directory(folder, none)) throw_cannot_write(path, in_quotes(folder) + " is not a folder");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw_cannot_write(path, "the folder " + in_quotes(folder) + " is not writable (" + reason(errno) + ")");
  }
}

void require_readable(const fs::path& path) {
  std::error_code none;
  if (!fs::exists(path, none)) throw IoError("there is no file " + in_quotes(path));
  if (fs::is_directory(path, none)) return;
  if (!fs::is_regular_file(path, none)) throw IoError(in_quotes(path) + " is not a file; name a file or a folder");
  const Descriptor file(path, O_RDONLY);
  if (!file.is_open()) throw IoError("cannot open " + in_quotes(path) + ": " + reason(errno));
  if (fs::is_regular_file(path, none) && fs::file_size(path, none) == 0) {
    throw IoError(in_quotes(path) + " is an empty file");
  }
}

std::string in_quotes(const fs::path& path) { return std::string(1, '\'').append(path.string()).append(1, '\''); }

std::string file_extension(const fs::path& path) {
  const auto small = [](std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
  };
  const std::string last = small(path.extension().string());
  return last == ".gz" ? small(path.stem().extension().string()) + last : last;
}

}  // namespace anatomesh
