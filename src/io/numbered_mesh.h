// A mesh whose points and tetrahedra have numbers of the file's choice, in any order.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {

struct NumberedPoint {
  std::int64_t number = 0;
  Vec3 place_mm;
};

struct NumberedTet {
  std::int64_t number = 0;
  std::array<std::int64_t, 4> corners = {};  ///< numbers of points
  Label label = 1;
};

/// What a file of a solver holds; nothing of it is checked yet.
struct NumberedMesh {
  std::vector<NumberedPoint> points;
  std::vector<NumberedTet> tets;
};

/// Puts points and tetrahedra into the order of their numbers.
/// Throws IoError (a number that two have), InvalidInput (no tetrahedra).
void sort_by_number(const std::filesystem::path& path, NumberedMesh& mesh);

/// The mesh in the order of the numbers. Throws as sort_by_number(), and IoError (a corner that is no point).
TetMesh tet_mesh_from(const std::filesystem::path& path, NumberedMesh mesh);

}  // namespace anatomesh
