// A mesh whose points and tetrahedra have numbers of the file's choice, in any order.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "anatomesh/tet_mesh.h"
#include "io/element_nodes.h"

namespace anatomesh {

struct NumberedPoint {
  std::int64_t number = 0;
  Vec3 place_mm;
};

struct NumberedTet {
  static constexpr auto kLinear = static_cast<std::uint32_t>(-1);

  std::int64_t number = 0;
  std::array<std::int64_t, 4> corners = {};  ///< numbers of points
  Label label = 1;
  std::uint32_t edge_nodes = kLinear;  ///< position in NumberedMesh::edge_nodes
};

/// What a file of a solver holds; nothing of it is checked yet.
struct NumberedMesh {
  std::vector<NumberedPoint> points;
  std::vector<NumberedTet> tets;
  std::vector<std::array<std::int64_t, 6>> edge_nodes;  ///< of quadratic tetrahedra, numbers of points

  /// A tetrahedron of 4 or 10 nodes, the corners first.
  void add(std::int64_t number, std::span<const std::int64_t> nodes, Label label,
           const EdgeNodeOrder& order = kUsualOrder);
};

/// Puts points and tetrahedra into the order of their numbers.
/// Throws IoError (a number that two have), InvalidInput (no tetrahedra, or linear and quadratic ones).
void sort_by_number(const std::filesystem::path& path, NumberedMesh& mesh);

/// The mesh in the order of the numbers. Throws as sort_by_number(), and IoError (a corner that is no point).
TetMesh tet_mesh_from(const std::filesystem::path& path, NumberedMesh mesh);

}  // namespace anatomesh
