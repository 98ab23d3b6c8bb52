// `anatomesh check`: measures a mesh and verifies the guarantees.
#pragma once

#include "apps/command.h"

namespace anatomesh::apps {

Command add_check_command(CLI::App& program);

}  // namespace anatomesh::apps
