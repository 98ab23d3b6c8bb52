// After "HDF5 File Format Specification Version 3.0" (https://docs.hdfgroup.org/hdf5/v1_10/_f_m_t3.html), IV.A.1
// (object headers) and IV.A.2.i (data layout). Headers that are damaged otherwise are left to the library.
#include "io/hdf5_layout.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace anatomesh {
namespace {

constexpr std::uint64_t kMostBlockBytes = std::uint64_t{1} << 20, kMostBlocks = 64;
constexpr std::uint64_t kLayout = 0x08, kContinuation = 0x10;
constexpr std::uint64_t kChunked = 2;

/// The number in some bytes, little end first; 0 beyond the end.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t n = 0; n < size && at + n < bytes.size(); ++n) {
    value |= std::uint64_t{static_cast<unsigned char>(bytes[at + n])} << (8 * n);
  }
  return value;
}

/// Where a version of the layout message has what.
struct LayoutVersion {
  std::uint64_t version;
  std::size_t layout_class, dimensions, first;  // bytes from the start
};
constexpr std::array kLayoutVersions = {LayoutVersion{1, 2, 1, 16}, LayoutVersion{2, 2, 1, 16},
                                        LayoutVersion{3, 1, 2, 11}, LayoutVersion{4, 1, 3, 5}};

bool is_empty_layout(std::string_view message) {
  const auto known = std::ranges::find(kLayoutVersions, number_at(message, 0, 1), &LayoutVersion::version);
  if (known == kLayoutVersions.end() || number_at(message, known->layout_class, 1) != kChunked) return false;
  const std::size_t bytes_each = known->version == 4 ? number_at(message, 4, 1) : 4;
  const std::uint64_t dimensions = number_at(message, known->dimensions, 1);  // the last is the size of a number
  for (std::size_t n = 0; n < dimensions; ++n) {
    if (number_at(message, known->first + n * bytes_each, bytes_each) == 0) return true;
  }
  return dimensions < 2;
}

/// Messages begin with their type and size.
struct MessageHead {
  std::size_t type_bytes, bytes;
};

/// A piece of a header: where its messages begin, and their heads.
struct HeaderStart {
  std::size_t begin, bytes;
  MessageHead head;
};

HeaderStart header_start(std::string_view bytes) {
  if (!bytes.starts_with("OHDR")) return {16, number_at(bytes, 8, 4), {2, 8}};
  const std::uint64_t flags = number_at(bytes, 5, 1);
  const std::size_t size_bytes = std::size_t{1} << (flags & 3u);
  const std::size_t size_at = 6 + ((flags & 0x20u) != 0 ? 16 : 0) + ((flags & 0x10u) != 0 ? 4 : 0);
  return {size_at + size_bytes, number_at(bytes, size_at, size_bytes), {1, (flags & 4u) != 0 ? 6u : 4u}};
}

class Headers {
 public:
  explicit Headers(const std::filesystem::path& file) : stream_(file, std::ios::binary) {}

  bool has_empty_chunks(std::uint64_t address) {
    const std::string first = bytes_at(address, 64);
    const HeaderStart start = header_start(first);
    blocks_ = {bytes_at(address + start.begin, start.bytes)};
    for (std::size_t n = 0; n < blocks_.size() && n < kMostBlocks; ++n) {
      const std::string block = blocks_[n];  // more are added meanwhile
      if (block_has_empty_chunks(block, start.head)) return true;
    }
    return false;
  }

 private:
  bool block_has_empty_chunks(std::string_view block, MessageHead head) {
    std::size_t at = block.starts_with("OCHK") ? 4 : 0;
    while (at + head.bytes <= block.size()) {
      const std::uint64_t type = number_at(block, at, head.type_bytes);
      const std::uint64_t size = number_at(block, at + head.type_bytes, 2);
      const std::string_view message = block.substr(at + head.bytes, size);
      if (type == kLayout && is_empty_layout(message)) return true;
      if (type == kContinuation) blocks_.push_back(bytes_at(number_at(message, 0, 8), number_at(message, 8, 8)));
      at += head.bytes + size;
    }
    return false;
  }

  std::string bytes_at(std::uint64_t address, std::uint64_t count) {
    std::string bytes(std::min(count, kMostBlockBytes), '\0');
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(address));
    stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream_.gcount()));
    return bytes;
  }

  std::ifstream stream_;
  std::vector<std::string> blocks_;
};

}  // namespace

bool has_empty_chunks(const std::filesystem::path& file, std::uint64_t header_address) {
  return Headers(file).has_empty_chunks(header_address);
}

}  // namespace anatomesh
