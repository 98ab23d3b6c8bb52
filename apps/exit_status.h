// What the program's exit status means.
#pragma once

namespace anatomesh::apps {

enum ExitStatus : int {
  kDone = 0,
  kCheckFailed = 1,    ///< `check` found a guarantee broken
  kWrongUsage = 2,     ///< an unknown option, or a value out of its range
  kBadInput = 3,       ///< a file that cannot be read or written, or an image that cannot be meshed
  kMeshingFailed = 4,  ///< no mesh could be made, memory ran out, or an error of the program's own
  kInterrupted = 130,  ///< Ctrl-C or a request to terminate
};

}  // namespace anatomesh::apps
