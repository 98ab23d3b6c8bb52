#include "apps/messages.h"

#include <fmt/core.h>

#include <cstdio>

namespace anatomesh::apps {

void put_on_stderr(const std::string& text) { std::fputs(text.c_str(), stderr); }

void print_error(std::string_view sentence) { put_on_stderr(fmt::format("anatomesh: error: {}\n", sentence)); }
void print_warning(std::string_view sentence) { put_on_stderr(fmt::format("anatomesh: warning: {}\n", sentence)); }
void print_note(std::string_view sentence) { put_on_stderr(fmt::format("anatomesh: {}\n", sentence)); }

}  // namespace anatomesh::apps
