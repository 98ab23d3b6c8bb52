// A labelled tetrahedral mesh in memory.
#pragma once

#include <array>
#include <vector>

#include "anatomesh/label_table.h"
#include "anatomesh/types.h"

namespace anatomesh {

/// A conforming tetrahedral mesh. For tetrahedron (a, b, c, d) the triple product
/// (b - a) x (c - a) . (d - a) is positive.
struct TetMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<VertexId, 4>> tets;
  std::vector<Label> labels;  ///< one a tetrahedron: its tissue
  LabelTable names = {};      ///< of the labels, where they are known
};

}  // namespace anatomesh
