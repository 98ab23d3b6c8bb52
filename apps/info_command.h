// `anatomesh info`: shows what an image is.
#pragma once

#include "apps/command.h"

namespace anatomesh::apps {

Command add_info_command(CLI::App& program);

}  // namespace anatomesh::apps
