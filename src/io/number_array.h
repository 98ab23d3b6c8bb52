// Arrays of numbers of one type, as files have them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "anatomesh/types.h"
#include "io/voxel_type.h"

namespace anatomesh {

/// Numbers of one type, in this machine's byte order.
struct NumberArray {
  NumberType type = NumberType::u8;
  std::vector<std::byte> bytes;
  std::size_t size() const { return bytes.size() / bytes_of(type); }
};

/// Turns the bytes of each number round.
void reverse_bytes(NumberArray& array);

/// For ids and offsets: what is negative, above 2^53 or no number becomes -1, which is out of range for all of them.
std::vector<std::int64_t> integers_of(const NumberArray& array);

/// Three numbers a point; those left over are dropped.
std::vector<Vec3> points_of(const NumberArray& array);

/// Bytes as texts, each up to a zero.
std::vector<std::string> texts_of(const NumberArray& array);

/// Calls with a zero of the C++ type of the given number type.
template <typename Call>
void with_number_type(NumberType type, Call&& call) {
  switch (type) {
    case NumberType::u8:
      return call(std::uint8_t{});
    case NumberType::i8:
      return call(std::int8_t{});
    case NumberType::u16:
      return call(std::uint16_t{});
    case NumberType::i16:
      return call(std::int16_t{});
    case NumberType::u32:
      return call(std::uint32_t{});
    case NumberType::i32:
      return call(std::int32_t{});
    case NumberType::u64:
      return call(std::uint64_t{});
    case NumberType::i64:
      return call(std::int64_t{});
    case NumberType::f32:
      return call(float{});
    case NumberType::f64:
      return call(double{});
  }
}

}  // namespace anatomesh
