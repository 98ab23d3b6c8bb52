// After G. Turk, "The PLY Polygon File Format" (1994). VTK's writer has 32-bit points and no labels.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "io/little_endian.h"
#include "io/number_text.h"
#include "io/surface_bytes.h"

namespace anatomesh {
namespace {

std::optional<Colour> colour_of(const Surface& surface, Label label) {
  const auto entry = surface.names.find(label);
  return entry == surface.names.end() ? std::nullopt : entry->second.colour;
}

std::string header(const Surface& surface, bool with_colours) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex ";
  text += number_text(surface.points_mm.size());
  text += "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
  text += number_text(triangle_count(surface));
  text += "\nproperty list uchar int vertex_indices\nproperty uint label\nproperty uint label_outside\n";
  if (with_colours) text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  return text += "end_header\n";
}

}  // namespace

std::string ply_bytes(const Surface& surface) {
  const bool with_colours = std::ranges::all_of(
      surface.parts, [&](const SurfacePart& part) { return colour_of(surface, part.inside).has_value(); });
  std::string bytes = header(surface, with_colours);
  for (const Vec3& p : surface.points_mm) {
    for (std::size_t axis = 0; axis < 3; ++axis) append_little_endian(bytes, p[axis]);
  }
  for (const SurfacePart& part : surface.parts) {
    std::string tail;  // equal for all faces of the part
    append_little_endian(tail, part.inside);
    append_little_endian(tail, part.outside);
    if (with_colours) {
      const Colour colour = *colour_of(surface, part.inside);
      for (const std::uint8_t channel : colour) append_little_endian(tail, channel);
    }
    for (const auto& triangle : part.triangles) {
      append_little_endian(bytes, static_cast<std::uint8_t>(triangle.size()));
      for (const VertexId vertex : triangle) append_little_endian(bytes, vertex);
      bytes += tail;
    }
  }
  return bytes;
}

}  // namespace anatomesh
