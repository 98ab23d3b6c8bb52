// Gmsh's format for meshes, MSH.
//
// Written is version 4.1, ASCII. Each tissue is a volume and a physical group, both with its label for a number and the
// group with its name; each interface and each part of the outer skin is a surface and a physical group as well. Points
// on surfaces belong to one of those, all others to their volume. The numbers of points and tetrahedra are their
// positions, counted from 1.
#pragma once

#include <filesystem>

#include "anatomesh/tet_mesh.h"
#include "io/element_nodes.h"

namespace anatomesh {

inline constexpr EdgeNodeOrder kGmshOrder = {0, 1, 2, 3, 5, 4};

/// Throws IoError, InvalidInput (the label 0, which is no number of a group).
void write_gmsh(const std::filesystem::path& path, const TetMesh& mesh);

/// Versions 4.1 and 2.2, ASCII or binary, of any tool. The label is the number of the physical group, else that of the
/// volume. Points and tetrahedra come in the order of their numbers. Throws IoError, InvalidInput: see read_mesh().
TetMesh read_gmsh(const std::filesystem::path& path);

}  // namespace anatomesh
