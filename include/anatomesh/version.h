// Which Anatomesh this is.
#pragma once

namespace anatomesh {

/// Version of the library, as "1.2.3".
const char* version();

}  // namespace anatomesh
