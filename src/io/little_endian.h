// Numbers as bytes, the little end first.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <string>

namespace anatomesh {

template <typename Number>
void append_little_endian(std::string& bytes, Number value) {
  auto stored = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(stored);
  bytes.append(stored.data(), stored.size());
}

}  // namespace anatomesh
