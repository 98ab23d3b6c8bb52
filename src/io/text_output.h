// Text on its way to a file.
#pragma once

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace anatomesh {

/// Takes text, characters and numbers, which read back to the same bits.
class TextOutput {
 public:
  template <typename Value>
  TextOutput& operator<<(const Value& value) {
    if constexpr (std::is_same_v<Value, char>) {
      bytes_.push_back(value);
    } else if constexpr (std::is_arithmetic_v<Value>) {
      std::array<char, 64> text;
      bytes_.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
    } else {
      bytes_.append(std::string_view(value));
    }
    return *this;
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace anatomesh
