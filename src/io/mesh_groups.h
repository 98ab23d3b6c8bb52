// The tissues and surfaces of a mesh as formats have them that number groups of elements.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "anatomesh/interfaces.h"

namespace anatomesh {

/// What both Gmsh and MEDIT store numbers of groups in: 32 bits with a sign.
inline constexpr Label kLargestGroup = 2147483647;

struct SurfaceGroup {
  Label tag = 0;     ///< its number, which no tissue and no other surface has
  std::string name;  ///< "brain_to_tumour", "brain_skin"
  Interface between;
};

struct MeshGroups {
  std::map<Label, std::string> tissues;  ///< names by label, which is the number of the group
  std::vector<SurfaceGroup> surfaces;    ///< in the order of interfaces_of()
};

/// Names are all different, tissues and surfaces together, and have at most so many bytes: see InterfaceNames. Surfaces
/// are numbered from above the largest label; where that leaves too few numbers, with those that are free.
MeshGroups mesh_groups(const TetMesh& mesh, std::size_t most_bytes);

}  // namespace anatomesh
