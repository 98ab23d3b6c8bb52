// After "VTK XML Formats" of VTK's documentation, the part on the data of arrays: [bytes][data], or, compressed,
// [blocks][bytes of a block][bytes of the last one where it is shorter, else 0][packed bytes of each block
// ...][blocks].
#include "io/vtk_xml_data.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>

#include "base/parallel.h"
#include "io/cell_arrays.h"

namespace anatomesh {
namespace {

/// Takes the sizes off the start of what is stored.
class Sizes {
 public:
  Sizes(std::string_view stored, const VtkXmlStorage& storage, const ArrayPlace& place)
      : rest_(stored), storage_(storage), place_(place) {}

  std::uint64_t next() {
    if (rest_.size() < storage_.bytes_a_size) place_.fail("is cut off");
    std::uint64_t size = 0;
    for (std::size_t n = 0; n < storage_.bytes_a_size; ++n) {
      const std::size_t at = storage_.order == std::endian::big ? n : storage_.bytes_a_size - 1 - n;
      size = size << 8 | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(storage_.bytes_a_size);
    return size;
  }

  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  const VtkXmlStorage& storage_;
  const ArrayPlace& place_;
};

struct Block {
  std::string_view packed;
  std::size_t begin = 0;  ///< in the unpacked data
  std::size_t bytes = 0;  ///< unpacked
};

std::vector<Block> blocks_of(Sizes sizes, const VtkXmlStorage& storage, const ArrayPlace& place) {
  const std::uint64_t count = sizes.next();
  if (count == 0) return {};
  const std::uint64_t each = sizes.next(), last = sizes.next();
  if (count > sizes.rest().size() / storage.bytes_a_size) place.fail("is cut off");
  std::vector<std::uint64_t> packed_bytes(count);
  for (std::uint64_t& bytes : packed_bytes) bytes = sizes.next();
  constexpr std::uint64_t kMostPacked = 1100;  // zlib makes nothing smaller than a 1032nd of it
  std::string_view rest = sizes.rest();
  std::vector<Block> blocks(count);
  std::size_t begin = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint64_t bytes = n + 1 == count && last != 0 ? last : each;
    if (packed_bytes[n] > rest.size()) place.fail("is cut off");
    if (bytes / kMostPacked > packed_bytes[n]) place.fail("has compressed blocks of impossible sizes");
    blocks[n] = {rest.substr(0, packed_bytes[n]), begin, bytes};
    rest.remove_prefix(packed_bytes[n]);
    begin += bytes;
  }
  return blocks;
}

bool unpack(const Block& block, std::byte* to) {
  uLongf bytes = block.bytes;
  const auto* packed = reinterpret_cast<const Bytef*>(block.packed.data());
  return uncompress(reinterpret_cast<Bytef*>(to), &bytes, packed, block.packed.size()) == Z_OK && bytes == block.bytes;
}

std::vector<std::byte> unpacked(const std::vector<Block>& blocks, const ArrayPlace& place) {
  std::vector<std::byte> data(blocks.empty() ? 0 : blocks.back().begin + blocks.back().bytes);
  std::atomic<bool> is_broken = false;
  constexpr std::size_t kBlocksAtOnce = 1;
  parallel_for(
      blocks.size(),
      [&](std::size_t n) {
        if (!unpack(blocks[n], data.data() + blocks[n].begin)) is_broken = true;
      },
      kBlocksAtOnce);
  if (is_broken) place.fail("has broken compressed data");
  return data;
}

}  // namespace

void ArrayPlace::fail(const std::string& why) const {
  throw_damaged(path, std::string("its array '").append(name).append("' ").append(why));
}

std::vector<std::byte> data_of(std::string_view stored, const VtkXmlStorage& storage, const ArrayPlace& place) {
  Sizes sizes(stored, storage, place);
  if (storage.is_compressed) return unpacked(blocks_of(sizes, storage, place), place);
  const std::uint64_t bytes = sizes.next();
  if (bytes > sizes.rest().size()) place.fail("is cut off");
  std::vector<std::byte> data(bytes);
  if (bytes > 0) std::memcpy(data.data(), sizes.rest().data(), bytes);
  return data;
}

}  // namespace anatomesh
