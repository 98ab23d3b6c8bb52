// Files that may be compressed with gzip.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {

/// A file that is decompressed while it is read, if it is compressed.
class ZipFile {
 public:
  explicit ZipFile(const std::filesystem::path& path) : path_(path), file_(gzopen(path.c_str(), "rb"), gzclose) {
    if (!file_) throw IoError("cannot open " + in_quotes(path));
    gzbuffer(file_.get(), 1U << 18);
  }

  /// Reads up to so many bytes; fewer at the end of the file.
  std::size_t read(std::byte* to, std::size_t bytes) {
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
    std::size_t done = 0;
    while (done < bytes) {
      const int got = gzread(file_.get(), to + done, static_cast<unsigned>(std::min(bytes - done, kMostAtOnce)));
      if (got < 0) throw IoError(in_quotes(path_) + " is truncated or damaged: its compressed data are broken");
      if (got == 0) break;
      done += static_cast<std::size_t>(got);
    }
    return done;
  }

  /// Passes over so many bytes, or to the end of the file.
  void skip(std::size_t bytes) {
    std::vector<std::byte> passed(std::min(bytes, std::size_t{1} << 16));
    while (bytes > 0) {
      const std::size_t got = read(passed.data(), std::min(bytes, passed.size()));
      if (got == 0) return;
      bytes -= got;
    }
  }

  /// Reads on to the end and forgets it: only there is the checksum of compressed data.
  void drain() {
    std::vector<std::byte> rest(std::size_t{1} << 16);
    while (read(rest.data(), rest.size()) == rest.size()) continue;
    int status = Z_OK;
    gzerror(file_.get(), &status);
    if (status == Z_BUF_ERROR) throw IoError(in_quotes(path_) + " is truncated: its compressed data have no end");
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

/// Throws IoError, about the image, where a file cannot hold so many bytes of voxels: zlib compresses to 1/1032 at
/// best. To be asked before memory is reserved for them.
inline void require_room_in_file(const std::filesystem::path& image, const std::filesystem::path& file, double bytes) {
  constexpr double kMostCompression = 1032;
  const auto present = static_cast<double>(std::filesystem::file_size(file));
  if (bytes <= kMostCompression * present) return;
  throw IoError(in_quotes(image) + " is truncated or damaged: " + number_text(present) +
                " bytes cannot hold the voxels that its header declares");
}

/// Reads so many bytes of voxels from behind an offset, and then to the end of the file. Throws IoError, about the
/// image, where there are fewer.
inline void read_voxels(const std::filesystem::path& image, const std::filesystem::path& file, std::size_t offset,
                        std::byte* voxels, std::size_t bytes) {
  ZipFile zip(file);
  zip.skip(offset);
  const std::size_t got = zip.read(voxels, bytes);
  if (got != bytes) {
    throw IoError(in_quotes(image) + " is truncated: it has " + number_text(got) + " of the " + number_text(bytes) +
                  " bytes of its voxels");
  }
  zip.drain();
}

}  // namespace anatomesh
