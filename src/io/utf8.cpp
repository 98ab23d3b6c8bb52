#include "io/utf8.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace anatomesh {
namespace {

/// Characters that begin with such a byte: its range, that of the second byte, and how many bytes they take.
struct Form {
  unsigned char first, last;
  unsigned char second_first, second_last;
  std::size_t bytes;
};

/// Table 3-7 of the Unicode standard; control characters are left out.
constexpr std::array<Form, 10> kForms = {{{0x09, 0x09, 0, 0, 1},
                                          {0x20, 0x7E, 0, 0, 1},
                                          {0xC2, 0xDF, 0x80, 0xBF, 2},
                                          {0xE0, 0xE0, 0xA0, 0xBF, 3},
                                          {0xE1, 0xEC, 0x80, 0xBF, 3},
                                          {0xED, 0xED, 0x80, 0x9F, 3},
                                          {0xEE, 0xEF, 0x80, 0xBF, 3},
                                          {0xF0, 0xF0, 0x90, 0xBF, 4},
                                          {0xF1, 0xF3, 0x80, 0xBF, 4},
                                          {0xF4, 0xF4, 0x80, 0x8F, 4}}};

bool lies_in(char c, unsigned char first, unsigned char last) {
  const auto byte = static_cast<unsigned char>(c);
  return first <= byte && byte <= last;
}

}  // namespace

bool is_one_line_of_utf8(std::string_view text) {
  while (!text.empty()) {
    const auto form =
        std::ranges::find_if(kForms, [&](const Form& f) { return lies_in(text.front(), f.first, f.last); });
    if (form == kForms.end() || form->bytes > text.size()) return false;
    if (form->bytes > 1 && !lies_in(text[1], form->second_first, form->second_last)) return false;
    for (std::size_t n = 2; n < form->bytes; ++n) {
      if (!lies_in(text[n], 0x80, 0xBF)) return false;
    }
    text.remove_prefix(form->bytes);
  }
  return true;
}

}  // namespace anatomesh
