// `anatomesh convert`: rewrites a mesh in another format.
#pragma once

#include "apps/command.h"

namespace anatomesh::apps {

Command add_convert_command(CLI::App& program);

}  // namespace anatomesh::apps
