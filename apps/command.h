// What main() needs of each command.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "apps/interrupt.h"

namespace anatomesh::apps {

struct Command {
  CLI::App* parser = nullptr;                ///< says whether the user chose this command
  std::function<int(const Interrupt&)> run;  ///< returns the exit status; may throw the library's errors
};

}  // namespace anatomesh::apps
