// The fields of a line.
#pragma once

#include <string_view>
#include <vector>

namespace anatomesh {

/// Fields between commas, without white space around them; "1, 2," has three, the last one empty. The vector is
/// emptied first, so that one will do for all lines.
void split_at_commas(std::string_view line, std::vector<std::string_view>& fields);

/// Words between white space. The vector is emptied first.
void split_at_spaces(std::string_view line, std::vector<std::string_view>& words);

}  // namespace anatomesh
