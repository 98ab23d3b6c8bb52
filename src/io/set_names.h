// Names of the sets of a mesh in files: one a label, each different from the others.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// What a format allows in the name of a set.
struct NameRule {
  bool identifier = false;       ///< letters, digits and _ only, a letter first; else all but quotes and controls
  std::size_t most_bytes = 127;  ///< of the name, at least 24
  bool tells_case_apart = true;  ///< whether "Skin" and "skin" are two names
};

/// A name for every label of the mesh's tetrahedra: that of its table as far as the rule allows, "label_7" where it has
/// none. Two labels of equal names get "_7" behind theirs.
std::map<Label, std::string> set_names(const TetMesh& mesh, const NameRule& rule);

/// What set_names() calls a label without a name: "label_7".
std::string default_set_name(Label label);

}  // namespace anatomesh
