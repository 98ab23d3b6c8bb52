#include "io/label_colour.h"

#include <charconv>
#include <system_error>

namespace anatomesh {

std::string colour_text(const Colour& colour) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned part : colour) {
    text += kDigits[part / 16];
    text += kDigits[part % 16];
  }
  return text;
}

std::optional<Colour> colour_from(std::string_view text) {
  if (text.size() != 7 || text.front() != '#') return std::nullopt;
  Colour colour;
  for (std::size_t part = 0; part < 3; ++part) {
    const char* const begin = text.data() + 1 + 2 * part;
    const auto [end, error] = std::from_chars(begin, begin + 2, colour[part], 16);
    if (error != std::errc() || end != begin + 2) return std::nullopt;
  }
  return colour;
}

}  // namespace anatomesh
