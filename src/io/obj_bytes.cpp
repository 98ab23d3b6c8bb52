// After "Object Files (.obj)", appendix B1 of Wavefront's Advanced Visualizer manual. VTK's writer has no groups.
#include "io/number_text.h"
#include "io/surface_bytes.h"

namespace anatomesh {

std::string obj_bytes(const Surface& surface) {
  std::string text =
      "# surfaces of a mesh, millimetres; a group is named after the tissue inside and the one outside\n";
  for (const Vec3& p : surface.points_mm) {
    text += "v";
    for (std::size_t axis = 0; axis < 3; ++axis) text.append(" ").append(number_text(p[axis]));
    text += "\n";
  }
  for (const SurfacePart& part : surface.parts) {
    text.append("g ").append(part.name).append("\n");
    for (const auto& triangle : part.triangles) {
      text += "f";
      for (const VertexId vertex : triangle) text.append(" ").append(number_text(std::uint64_t{vertex} + 1));
      text += "\n";
    }
  }
  return text;
}

}  // namespace anatomesh
