// One line a message, on the error stream.
#pragma once

#include <string>
#include <string_view>

namespace anatomesh::apps {

/// Writes to standard error as far as it can be had: where it is closed or full the work goes on without.
void put_on_stderr(const std::string& text);

void print_error(std::string_view sentence);
void print_warning(std::string_view sentence);
void print_note(std::string_view sentence);

}  // namespace anatomesh::apps
