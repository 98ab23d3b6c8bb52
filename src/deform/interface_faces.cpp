#include "deform/interface_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

// The border plane that p is farthest beyond, or on.
std::optional<BorderPlane> border_crossed(const TissueImage& image, Vec3 p) {
  std::optional<BorderPlane> crossed;
  double farthest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double low = image.low_border_mm(axis), high = image.high_border_mm(axis);
    const double beyond = std::max(low - p[axis], p[axis] - high);
    if (beyond < farthest) continue;
    farthest = beyond;
    crossed = BorderPlane{axis, p[axis] < low ? low : high};
  }
  return crossed;
}

double distance_from_border(const TissueImage& image, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis)
    least = std::min(
        {least, std::abs(p[axis] - image.low_border_mm(axis)), std::abs(p[axis] - image.high_border_mm(axis))});
  return least;
}

TissueId tissue_at(const TissueImage& image, Vec3 p) {
  const auto [i, j, k] = image.index_at(p);
  return image.at_or_background(i, j, k);
}

// The border plane where the tissue behind a face toward the background ends, seen along the face's normal: none where
// it ends inside the image, nearer to the face.
std::optional<BorderPlane> border_at(const TissueMesh& mesh, const TissueImage& image, const InterfaceFace& face) {
  const Vec3 a = mesh.points_mm[face.vertices[0]], b = mesh.points_mm[face.vertices[1]],
             c = mesh.points_mm[face.vertices[2]];
  const Vec3 centre = centroid(mesh, face), inward = area_vector(mesh, face);
  const Vec3 voxel = image.spacing_mm;
  const double longest = std::sqrt(std::max({norm_squared(b - a), norm_squared(c - b), norm_squared(a - c)}));
  const double widest = std::max({voxel.x, voxel.y, voxel.z});
  const double reach = std::clamp(longest, 2 * widest, 16 * widest);
  if (distance_from_border(image, centre) > reach) return {};
  constexpr double kMostSteps = 64;
  const double step = std::max(0.5 * std::min({voxel.x, voxel.y, voxel.z}), reach / kMostSteps);
  const Vec3 along = (-step / norm(inward)) * inward;
  const int steps = static_cast<int>(std::ceil(reach / step));
  std::optional<BorderPlane> nearest;
  int least = steps + 1;
  for (int n = -steps; n <= steps && n < least; ++n) {
    const Vec3 p = centre + (n - 0.5) * along, q = p + along;
    if (std::abs(n) >= least || border_crossed(image, p) || tissue_at(image, p) != face.high) continue;
    const auto border = border_crossed(image, q);
    if (!border && tissue_at(image, q) == face.high) continue;
    least = std::abs(n);
    nearest = border;
  }
  return nearest;
}

void append_faces(const TissueMesh& mesh, const TissueImage& image, std::vector<Side>& sides,
                  std::vector<InterfaceFace>& faces) {
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tuple(s.middle, s.last, s.tet); });
  for (std::size_t n = 0; n + 1 < sides.size(); ++n) {
    const Side &a = sides[n], &b = sides[n + 1];
    if (a.middle != b.middle || a.last != b.last) continue;
    const TissueId of_a = mesh.tissues[a.tet], of_b = mesh.tissues[b.tet];
    if (of_a == of_b) continue;
    InterfaceFace& face = faces.emplace_back(of_a < of_b ? InterfaceFace{b.inward, of_a, of_b, {}}
                                                         : InterfaceFace{a.inward, of_b, of_a, {}});
    if (face.low == 0) face.border = border_at(mesh, image, face);
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

Vec3 centroid(const TissueMesh& mesh, const InterfaceFace& face) {
  return (1.0 / 3) *
         (mesh.points_mm[face.vertices[0]] + mesh.points_mm[face.vertices[1]] + mesh.points_mm[face.vertices[2]]);
}

Vec3 area_vector(const TissueMesh& mesh, const InterfaceFace& face) {
  const Vec3 a = mesh.points_mm[face.vertices[0]];
  return 0.5 * cross(mesh.points_mm[face.vertices[1]] - a, mesh.points_mm[face.vertices[2]] - a);
}

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
