#include "base/rotation.h"

#include <cmath>
#include <limits>

#include "base/vec.h"

namespace anatomesh {
namespace {

Vec3 column(const Mat3& m, std::size_t c) { return {m[0][c], m[1][c], m[2][c]}; }

Mat3 from_columns(Vec3 a, Vec3 b, Vec3 c) { return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}}; }

}  // namespace

double deviation_from_orthonormal(const Mat3& matrix) {
  double worst = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a; b < 3; ++b) {
      const double entry = std::abs(dot(column(matrix, a), column(matrix, b)) - (a == b ? 1 : 0));
      if (!(entry <= worst)) worst = entry;
      if (std::isnan(worst)) return worst;
    }
  }
  return worst;
}

Mat3 nearest_orthonormal(Mat3 matrix) {
  // One that is as near as rounding allows would only be rounded anew: an image that a reader has put right stays as it
  // is.
  if (deviation_from_orthonormal(matrix) <= 8 * std::numeric_limits<double>::epsilon()) return matrix;
  // Newton's iteration for the polar decomposition, M <- (M + transpose(inverse(M))) / 2 (Higham 1986).
  // It squares the deviation each time: four steps take 1e-4 below rounding.
  for (int step = 0; step < 4; ++step) {
    const Vec3 a = column(matrix, 0), b = column(matrix, 1), c = column(matrix, 2);
    const double scale = 1 / dot(a, cross(b, c));
    matrix =
        from_columns(0.5 * (a + scale * cross(b, c)), 0.5 * (b + scale * cross(c, a)), 0.5 * (c + scale * cross(a, b)));
  }
  return matrix;
}

}  // namespace anatomesh
