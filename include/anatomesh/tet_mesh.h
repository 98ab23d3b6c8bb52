// A labelled tetrahedral mesh in memory.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "anatomesh/label_table.h"
#include "anatomesh/types.h"

namespace anatomesh {

/// The corners that each edge node of a quadratic tetrahedron lies between, in the order of VTK, Abaqus and Nastran.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kEdgeNodeCorners = {
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// A conforming tetrahedral mesh. For tetrahedron (a, b, c, d) the triple product
/// (b - a) x (c - a) . (d - a) is positive.
struct TetMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<VertexId, 4>> tets;  ///< corners
  std::vector<Label> labels;                  ///< one a tetrahedron: its tissue
  LabelTable names = {};                      ///< of the labels, where they are known
  /// Of quadratic tetrahedra, one list a tetrahedron: points half-way along its edges, see kEdgeNodeCorners, which
  /// those around an edge share. Empty: linear tetrahedra.
  std::vector<std::array<VertexId, 6>> edge_nodes = {};
};

}  // namespace anatomesh
