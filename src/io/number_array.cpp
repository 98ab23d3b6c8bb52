#include "io/number_array.h"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace anatomesh {
namespace {

template <typename Value>
std::int64_t in_int64(Value value) {
  constexpr std::int64_t kMost = std::int64_t{1} << 53;
  return value >= 0 && static_cast<double>(value) <= static_cast<double>(kMost) ? static_cast<std::int64_t>(value) : -1;
}

}  // namespace

void reverse_bytes(NumberArray& array) {
  const auto each = static_cast<std::ptrdiff_t>(bytes_of(array.type));
  for (auto value = array.bytes.begin(); value != array.bytes.end(); value += each) std::reverse(value, value + each);
}

std::vector<std::int64_t> integers_of(const NumberArray& array) {
  std::vector<std::int64_t> result(array.size());
  with_number_type(array.type, [&]<typename Value>(Value value) {
    for (std::size_t n = 0; n < result.size(); ++n) {
      std::memcpy(&value, array.bytes.data() + n * sizeof(Value), sizeof(Value));
      result[n] = in_int64(value);
    }
  });
  return result;
}

std::vector<Vec3> points_of(const NumberArray& array) {
  std::vector<Vec3> result(array.size() / 3);
  with_number_type(array.type, [&]<typename Value>(Value value) {
    for (std::size_t n = 0; n < 3 * result.size(); ++n) {
      std::memcpy(&value, array.bytes.data() + n * sizeof(Value), sizeof(Value));
      result[n / 3][n % 3] = static_cast<double>(value);
    }
  });
  return result;
}

std::vector<std::string> texts_of(const NumberArray& array) {
  std::vector<std::string> result;
  auto begin = array.bytes.begin();
  for (auto end = begin; (end = std::find(begin, array.bytes.end(), std::byte{0})) != array.bytes.end();
       begin = end + 1) {
    std::string& text = result.emplace_back();
    std::transform(begin, end, std::back_inserter(text), [](std::byte byte) { return static_cast<char>(byte); });
  }
  return result;
}

}  // namespace anatomesh
