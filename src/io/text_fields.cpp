#include "io/text_fields.h"

#include <algorithm>

#include "io/text_cursor.h"

namespace anatomesh {

void split_at_commas(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return;
    line.remove_prefix(comma + 1);
  }
}

void split_at_spaces(std::string_view line, std::vector<std::string_view>& words) {
  constexpr std::string_view kSpaces = " \t\r\n\v\f";
  words.clear();
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
    if (line.empty()) return;
    const std::size_t end = std::min(line.find_first_of(kSpaces), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

}  // namespace anatomesh
