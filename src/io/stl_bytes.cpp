// After "StL" in M. Burns, Automated Fabrication (1993), section 6.5: the binary form. VTK's writer of it can only
// write to a file by its name.
#include <array>
#include <cmath>
#include <cstdint>

#include "base/vec.h"
#include "io/little_endian.h"
#include "io/surface_bytes.h"

namespace anatomesh {
namespace {

constexpr std::size_t kHeaderBytes = 80;

void append_point(std::string& bytes, const Vec3& p) {
  for (std::size_t axis = 0; axis < 3; ++axis) append_little_endian(bytes, static_cast<float>(p[axis]));
}

Vec3 unit_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(b - a, c - a);
  const double length = norm(normal);
  return length > 0 ? (1 / length) * normal : Vec3{};
}

}  // namespace

std::string stl_bytes(const Surface& surface) {
  std::string bytes = "binary STL, millimetres";  // it must not begin with "solid"
  bytes.resize(kHeaderBytes, ' ');
  append_little_endian(bytes, static_cast<std::uint32_t>(triangle_count(surface)));
  for (const SurfacePart& part : surface.parts) {
    for (const auto& [a, b, c] : part.triangles) {
      const std::array corners = {surface.points_mm[a], surface.points_mm[b], surface.points_mm[c]};
      append_point(bytes, unit_normal(corners[0], corners[1], corners[2]));
      for (const Vec3& corner : corners) append_point(bytes, corner);
      append_little_endian(bytes, std::uint16_t{0});
    }
  }
  return bytes;
}

}  // namespace anatomesh
