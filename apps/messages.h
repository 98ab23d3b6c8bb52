// One line a message, on the error stream.
#pragma once

#include <string_view>

namespace anatomesh::apps {

void print_error(std::string_view sentence);
void print_warning(std::string_view sentence);
void print_note(std::string_view sentence);

}  // namespace anatomesh::apps
