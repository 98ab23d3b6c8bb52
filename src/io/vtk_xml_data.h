// The bytes of one array in VTK's XML files: numbers that tell sizes, then the data, perhaps in compressed blocks.
#pragma once

#include <bit>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace anatomesh {

/// How all arrays of a file are stored.
struct VtkXmlStorage {
  std::endian order = std::endian::little;
  std::size_t bytes_a_size = 4;  ///< of each number that tells a size: 4 or 8
  bool is_compressed = false;    ///< with zlib, in blocks
};

/// Which array of which file, for messages.
struct ArrayPlace {
  const std::filesystem::path& path;
  std::string_view name;
  /// Throws IoError.
  [[noreturn]] void fail(const std::string& why) const;
};

/// The data behind the sizes at the start of what is stored; bytes after them are no matter. Blocks are unpacked in
/// parallel. Throws IoError, before it makes room for more than can be there.
std::vector<std::byte> data_of(std::string_view stored, const VtkXmlStorage& storage, const ArrayPlace& place);

}  // namespace anatomesh
