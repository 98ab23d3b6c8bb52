#include "io/image_geometry.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anatomesh/errors.h"
#include "base/vec.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

Vec3 column(const Mat3& m, std::size_t c) { return {m[0][c], m[1][c], m[2][c]}; }

Mat3 from_columns(Vec3 a, Vec3 b, Vec3 c) { return {{{a.x, b.x, c.x}, {a.y, b.y, c.y}, {a.z, b.z, c.z}}}; }

bool is_finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(Vec3 v) {
  std::string triple = number_text(v.x);
  for (const double number : {v.y, v.z}) triple.append(", ").append(number_text(number));
  return triple;
}

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

Vec3 physical_point(const ImageGeometry& geometry, Vec3 index) {
  const Vec3 s = geometry.spacing_mm;
  return geometry.origin_mm + geometry.direction * Vec3{index.x * s.x, index.y * s.y, index.z * s.z};
}

ImageGeometry checked_geometry(const std::filesystem::path& path, const ImageGeometry& geometry) {
  const Vec3 s = geometry.spacing_mm;
  if (!is_finite(s) || !(s.x > 0 && s.y > 0 && s.z > 0)) {
    throw InvalidInput(in_quotes(path) + " has the voxel spacing " + text(s) + " (mm); all three must be above 0");
  }
  if (!is_finite(geometry.origin_mm)) {
    throw InvalidInput(in_quotes(path) + " has the origin " + text(geometry.origin_mm) + "; it must be finite");
  }
  const double deviation = deviation_from_orthonormal(geometry.direction);
  if (!(deviation <= kDirectionTolerance)) {
    throw InvalidInput(in_quotes(path) + " has a direction matrix that is not a rotation (off by " +
                       number_text(deviation) + ", at most " + number_text(kDirectionTolerance) +
                       " is allowed); resample it to axes at right angles");
  }
  return {s, geometry.origin_mm, nearest_orthonormal(geometry.direction)};
}

}  // namespace anatomesh
