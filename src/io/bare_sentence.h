// The words of ITK and VTK, without their file names and addresses.
#pragma once

#include <string>

namespace anatomesh {

/// "WARNING: In file.cxx, line 7\nClass (0x12ab): text.\n\n" becomes "text".
std::string bare_sentence(const std::string& message);

}  // namespace anatomesh
