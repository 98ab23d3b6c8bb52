#include "deform/interface_faces.h"

#include <algorithm>
#include <tuple>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Faces opposite to each corner, seen from inside anticlockwise: their normals point into the tetrahedron.
constexpr std::array<std::array<std::size_t, 3>, 4> kInward = {{{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

// A face of a tetrahedron, found at its vertex of the lowest number.
struct Side {
  VertexId middle, last;  // the other two vertices, in order of number
  TetId tet;
  std::array<VertexId, 3> inward;
};

bool all_on_interfaces(const MeshTopology& topology, const std::array<VertexId, 3>& face) {
  return std::ranges::all_of(face, [&](VertexId v) { return topology.on_interface(v); });
}

void append_sides(const TissueMesh& mesh, const MeshTopology& topology, VertexId v, std::vector<Side>& sides) {
  for (const TetId t : topology.tets_of_vertex[v]) {
    for (const auto& corners : kInward) {
      const std::array<VertexId, 3> face = {mesh.tets[t][corners[0]], mesh.tets[t][corners[1]],
                                            mesh.tets[t][corners[2]]};
      if (std::ranges::min(face) != v || !all_on_interfaces(topology, face)) continue;
      const VertexId last = std::ranges::max(face);
      sides.push_back({face[0] ^ face[1] ^ face[2] ^ v ^ last, last, t, face});
    }
  }
}

// The border plane that the tetrahedron is farthest beyond.
std::optional<BorderPlane> border_crossed(const TissueMesh& mesh, TetId t, const TissueImage& image) {
  if (mesh.tissues[t] != 0) return {};
  Vec3 centre;
  for (const VertexId v : mesh.tets[t]) centre += 0.25 * mesh.points_mm[v];
  std::optional<BorderPlane> crossed;
  double farthest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = image.low_border_mm(axis), high = image.high_border_mm(axis);
    const double beyond = std::max(low - centre[axis], centre[axis] - high);
    if (beyond <= farthest) continue;
    farthest = beyond;
    crossed = BorderPlane{axis, centre[axis] < low ? low : high};
  }
  return crossed;
}

void append_faces(const TissueMesh& mesh, const TissueImage& image, std::vector<Side>& sides,
                  std::vector<InterfaceFace>& faces) {
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.middle, s.last, s.tet); });
  for (std::size_t n = 0; n + 1 < sides.size(); ++n) {
    const Side &a = sides[n], &b = sides[n + 1];
    if (a.middle != b.middle || a.last != b.last) continue;
    const TissueId of_a = mesh.tissues[a.tet], of_b = mesh.tissues[b.tet];
    if (of_a < of_b) faces.push_back({b.inward, of_a, of_b, border_crossed(mesh, a.tet, image)});
    if (of_b < of_a) faces.push_back({a.inward, of_b, of_a, border_crossed(mesh, b.tet, image)});
  }
}

VertexLists<std::uint32_t> faces_of_vertices(std::size_t vertex_count, const std::vector<InterfaceFace>& faces) {
  VertexLists<std::uint32_t> lists;
  lists.begin.assign(vertex_count + 1, 0);
  for (const InterfaceFace& face : faces) {
    for (const VertexId v : face.vertices) ++lists.begin[v + 1];
  }
  for (std::size_t v = 0; v < vertex_count; ++v) lists.begin[v + 1] += lists.begin[v];
  lists.items.resize(lists.begin.back());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    for (const VertexId v : faces[f].vertices) lists.items[next[v]++] = f;
  }
  return lists;
}

}  // namespace

InterfaceFaces find_interface_faces(const TissueMesh& mesh, const MeshTopology& topology, const TissueImage& image) {
  constexpr std::size_t kGrain = 4096;
  const std::size_t vertices = mesh.points_mm.size();
  std::vector<std::vector<InterfaceFace>> blocks(vertices / kGrain + 1);
  parallel_blocks(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Side> sides;
    for (std::size_t v = begin; v < end; ++v) {
      if (!topology.on_interface(static_cast<VertexId>(v))) continue;
      sides.clear();
      append_sides(mesh, topology, static_cast<VertexId>(v), sides);
      append_faces(mesh, image, sides, blocks[begin / kGrain]);
    }
  });
  InterfaceFaces found;
  for (const auto& block : blocks) found.faces.insert(found.faces.end(), block.begin(), block.end());
  found.of_vertex = faces_of_vertices(vertices, found.faces);
  return found;
}

}  // namespace anatomesh
