#include "io/surface.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/sort_and_unify.h"
#include "io/element_nodes.h"
#include "io/interface_names.h"
#include "io/set_names.h"

namespace anatomesh {
namespace {

constexpr std::size_t kMostNameBytes = 100;  // file systems allow 255 for all of a file's name

/// A face of a quadratic tetrahedron becomes four.
void add_triangles(const TetMesh& mesh, TetFace face, SurfacePart& part) {
  const auto [a, b, c] = corners_of(mesh, face);
  if (!is_quadratic(mesh)) return part.triangles.push_back({a, b, c});
  const auto [ab, bc, ca] = edge_nodes_of(mesh, face);
  part.triangles.insert(part.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
}

SurfacePart part_of(const TetMesh& mesh, const Interface& interface) {
  SurfacePart part{interface.inside, interface.outside, {}, {}};
  for (const TetFace face : interface.faces) add_triangles(mesh, face, part);
  return part;
}

SurfacePart seen_from_outside(SurfacePart part) {
  std::swap(part.inside, part.outside);
  for (auto& triangle : part.triangles) std::swap(triangle[1], triangle[2]);
  return part;
}

// Renumbers the vertices of the mesh; only those in use are kept.
void take_points(const TetMesh& mesh, Surface& surface) {
  std::vector<VertexId> used;
  for (const SurfacePart& part : surface.parts) {
    for (const auto& triangle : part.triangles) used.insert(used.end(), triangle.begin(), triangle.end());
  }
  sort_and_unify(used);
  for (const VertexId vertex : used) surface.points_mm.push_back(mesh.points_mm[vertex]);
  for (SurfacePart& part : surface.parts) {
    for (auto& triangle : part.triangles) {
      for (VertexId& v : triangle) v = static_cast<VertexId>(std::ranges::lower_bound(used, v) - used.begin());
    }
  }
}

void complete(const TetMesh& mesh, const std::map<Label, std::string>& names, Surface& surface) {
  take_points(mesh, surface);
  InterfaceNames spoken(names, 2 * kMostNameBytes + 8);
  for (SurfacePart& part : surface.parts) part.name = spoken.name_of(part.inside, part.outside);
  surface.names = mesh.names;
}

}  // namespace

Surface interface_surface(const TetMesh& mesh) {
  Surface surface;
  for (const Interface& interface : interfaces_of(mesh)) surface.parts.push_back(part_of(mesh, interface));
  complete(mesh, tissue_names(mesh), surface);
  return surface;
}

std::map<Label, Surface> tissue_surfaces(const TetMesh& mesh) {
  std::map<Label, Surface> surfaces;
  const std::set<Label> tissues(mesh.labels.begin(), mesh.labels.end());
  for (const Interface& interface : interfaces_of(mesh)) {
    SurfacePart part = part_of(mesh, interface);
    // A tissue that is labelled 0 can only be inside: it is the smallest label.
    if (interface.outside != 0) surfaces[interface.outside].parts.push_back(seen_from_outside(part));
    surfaces[interface.inside].parts.push_back(std::move(part));
  }
  const std::map<Label, std::string> names = tissue_names(mesh);
  for (auto& [label, surface] : surfaces) complete(mesh, names, surface);
  return surfaces;
}

std::size_t triangle_count(const Surface& surface) {
  std::size_t count = 0;
  for (const SurfacePart& part : surface.parts) count += part.triangles.size();
  return count;
}

std::map<Label, std::string> tissue_names(const TetMesh& mesh) {
  return set_names(mesh, {.identifier = true, .most_bytes = kMostNameBytes, .tells_case_apart = false});
}

}  // namespace anatomesh
