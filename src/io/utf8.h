// Text that others can show.
#pragma once

#include <string_view>

namespace anatomesh {

/// Whether the bytes are UTF-8 (RFC 3629) without control characters but tabs.
bool is_one_line_of_utf8(std::string_view text);

}  // namespace anatomesh
