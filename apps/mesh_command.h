// `anatomesh mesh`: makes a mesh of an image.
#pragma once

#include "apps/command.h"

namespace anatomesh::apps {

Command add_mesh_command(CLI::App& program);

}  // namespace anatomesh::apps
