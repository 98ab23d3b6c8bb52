#include "io/base64.h"

#include <array>
#include <cctype>
#include <cstdint>

namespace anatomesh {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNone = 64;

/// The value of each character; kNone for those that are no digits.
constexpr std::array<std::uint8_t, 256> digit_values() {
  std::array<std::uint8_t, 256> values{};
  values.fill(kNone);
  for (std::size_t n = 0; n < kDigits.size(); ++n) {
    values[static_cast<unsigned char>(kDigits[n])] = static_cast<std::uint8_t>(n);
  }
  return values;
}

constexpr std::array<std::uint8_t, 256> kValues = digit_values();

std::uint8_t value_of(char c) { return kValues[static_cast<unsigned char>(c)]; }

/// Up to four characters that stand for up to three bytes.
class Group {
 public:
  bool is_empty() const { return digits_ + padding_ == 0; }
  bool is_full() const { return digits_ + padding_ == 4; }

  /// False where the character does not fit here.
  bool add(char c) {
    const bool is_padding = c == '=';
    const std::uint8_t value = is_padding ? std::uint8_t{0} : value_of(c);
    if (value == kNone || (is_padding ? digits_ < 2 : padding_ > 0)) return false;
    bits_ = bits_ << 6 | value;
    ++(is_padding ? padding_ : digits_);
    return true;
  }

  void flush(std::string& to) {
    for (unsigned n = 0; n + 1 < digits_; ++n) to += static_cast<char>(bits_ >> (16 - 8 * n) & 0xFFu);
    *this = Group();
  }

 private:
  std::uint32_t bits_ = 0;
  unsigned digits_ = 0;
  unsigned padding_ = 0;
};

}  // namespace

std::optional<std::string> base64_decoded(std::string_view text) {
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  Group group;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0) continue;
    if (!group.add(c)) return std::nullopt;
    if (group.is_full()) group.flush(bytes);
  }
  if (!group.is_empty()) return std::nullopt;
  return bytes;
}

}  // namespace anatomesh
