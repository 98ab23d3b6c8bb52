#include "io/image_geometry.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anatomesh/errors.h"
#include "base/rotation.h"
#include "base/vec.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

bool is_finite(Vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

std::string text(Vec3 v) {
  std::string triple = number_text(v.x);
  for (const double number : {v.y, v.z}) triple.append(", ").append(number_text(number));
  return triple;
}

}  // namespace

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
