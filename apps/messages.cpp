#include "apps/messages.h"

#include <fmt/core.h>

#include <cstdio>

namespace anatomesh::apps {

void print_error(std::string_view sentence) { fmt::print(stderr, "anatomesh: error: {}\n", sentence); }
void print_warning(std::string_view sentence) { fmt::print(stderr, "anatomesh: warning: {}\n", sentence); }
void print_note(std::string_view sentence) { fmt::print(stderr, "anatomesh: {}\n", sentence); }

}  // namespace anatomesh::apps
