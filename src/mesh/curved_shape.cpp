// After A. Johnen, J.-F. Remacle, C. Geuzaine, "Geometrical validity of curvilinear finite elements", J. Comput. Phys.
// 233 (2013): bounds of the Jacobian by its Bezier coefficients.
#include "mesh/curved_shape.h"

#include <algorithm>
#include <cmath>

#include "anatomesh/tet_mesh.h"

namespace anatomesh {
namespace {

/// The edge node between two corners, by their numbers.
constexpr std::array<std::array<std::size_t, 4>, 4> kNodeBetween = {
    {{0, 0, 2, 3}, {0, 0, 1, 4}, {2, 1, 0, 5}, {3, 4, 5, 0}}};

/// Direction in which the edge from a corner to another leaves it.
Vec3 tangent(const CurvedTet& tet, std::size_t from, std::size_t to) {
  return 4 * tet.edge_nodes[kNodeBetween[from][to]] - 3 * tet.corners[from] - tet.corners[to];
}

/// Control points of the quadratic Bezier tetrahedron: rows and columns are corners.
using ControlPoints = std::array<std::array<Vec3, 4>, 4>;

ControlPoints control_points(const CurvedTet& tet) {
  ControlPoints points;
  for (std::size_t i = 0; i < 4; ++i) {
    points[i][i] = tet.corners[i];
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 chord_middle = 0.5 * (tet.corners[i] + tet.corners[j]);
      points[i][j] = points[j][i] = 2 * tet.edge_nodes[kNodeBetween[i][j]] - chord_middle;
    }
  }
  return points;
}

/// The place of the product of three barycentric coordinates among the 20 of degree 3: the numbers of the corners with
/// two bits each, ascending.
std::size_t product_of(std::size_t i, std::size_t j, std::size_t k) {
  if (i > j) std::swap(i, j);
  if (j > k) std::swap(j, k);
  if (i > j) std::swap(i, j);
  return 16 * i + 4 * j + k;
}

}  // namespace

TetGeometry::CosineRange corner_angles(const CurvedTet& tet) {
  TetGeometry::CosineRange range;
  for (const auto& [i, j, k, l] : kCornersFrom) {
    const Vec3 a = tangent(tet, i, j), b = tangent(tet, i, k), c = tangent(tet, i, l);
    const std::array normals = {cross(b, a), cross(c, b), cross(a, c)};
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3 &one = normals[n], &other = normals[(n + 1) % 3];
      const double cosine = -dot(one, other) / std::sqrt(norm_squared(one) * norm_squared(other));
      range.largest = std::max(range.largest, cosine);
      range.smallest = std::min(range.smallest, cosine);
    }
  }
  return range;
}

double least_jacobian(const CurvedTet& tet) {
  const ControlPoints points = control_points(tet);
  // The derivative along the edge from corner 0 to corner n has at corner i the share edges[n - 1][i] of its value.
  std::array<std::array<Vec3, 4>, 3> edges;
  for (std::size_t n = 0; n < 3; ++n) {
    for (std::size_t i = 0; i < 4; ++i) edges[n][i] = points[n + 1][i] - points[0][i];
  }
  std::array<double, 64> sums{};
  std::array<int, 64> counts{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const Vec3 normal = cross(edges[0][i], edges[1][j]);
      for (std::size_t k = 0; k < 4; ++k) {
        sums[product_of(i, j, k)] += dot(normal, edges[2][k]);
        ++counts[product_of(i, j, k)];
      }
    }
  }
  // The edges above are half of the derivatives, and so are those of the straight tetrahedron here.
  const auto& [a, b, c, d] = tet.corners;
  const double straight = six_volumes(a, b, c, d) / 8;
  double least = 1;
  for (std::size_t n = 0; n < sums.size(); ++n) {
    if (counts[n] > 0) least = std::min(least, sums[n] / (counts[n] * straight));
  }
  return least;
}

}  // namespace anatomesh
