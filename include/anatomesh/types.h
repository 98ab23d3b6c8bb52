// The plain types that every floor and every user of the library shares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace anatomesh {

/// Value of a tissue in the image and in the mesh; 0 is background. Kept exactly up to 2^32 - 1.
using Label = std::uint32_t;

/// Position in TetMesh::points_mm.
using VertexId = std::uint32_t;

/// Position in TetMesh::tets.
using TetId = std::uint32_t;

/// Point or vector of three reals; in millimetres unless a name says otherwise.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  bool operator==(const Vec3&) const = default;
};

/// 3x3 matrix, row-major: m[row][column].
using Mat3 = std::array<std::array<double, 3>, 3>;

/// Identity matrix.
inline constexpr Mat3 kIdentity3 = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// Physical space in which a mesh is given: ITK's (left, posterior, superior) or (right, anterior,
/// superior); the first two axes have opposite signs.
enum class Frame { lps, ras };

}  // namespace anatomesh
