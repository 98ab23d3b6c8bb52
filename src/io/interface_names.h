// Names of the surfaces of a mesh in files.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "anatomesh/types.h"

namespace anatomesh {

/// Names interfaces after their tissues, each in another way.
class InterfaceNames {
 public:
  /// tissues: names by label, see set_names(), which must outlive this; no surface gets one of them. Names have at most
  /// so many bytes (at least 40).
  InterfaceNames(const std::map<Label, std::string>& tissues, std::size_t most_bytes);

  /// Of the faces between two labels, the second being 0 for the outer skin, as in Interface; to be asked once for
  /// each. "brain_to_tumour" or "brain_skin"; with the labels instead, "interface_3_17" or "skin_of_3", where that is
  /// too long or, but for capitals, taken.
  std::string name_of(Label inside, Label outside);

 private:
  const std::map<Label, std::string>& tissues_;
  std::size_t most_bytes_;
  std::set<std::string> taken_;  // in small letters
};

}  // namespace anatomesh
