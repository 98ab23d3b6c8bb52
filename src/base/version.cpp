#include "anatomesh/version.h"

namespace anatomesh {

const char* version() { return ANATOMESH_VERSION; }

}  // namespace anatomesh
