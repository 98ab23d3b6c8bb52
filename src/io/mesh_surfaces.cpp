#include "io/mesh_surfaces.h"

#include <algorithm>
#include <set>

#include "io/number_text.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

std::string spoken_name(const Interface& surface, const std::map<Label, std::string>& names) {
  const std::string& inside = names.at(surface.inside);
  return surface.outside == 0 ? inside + "_skin" : inside + "_to_" + names.at(surface.outside);
}

std::string numbered_name(const Interface& surface) {
  const std::string inside = number_text(surface.inside);
  return surface.outside == 0 ? "skin_of_" + inside : "interface_" + inside + "_" + number_text(surface.outside);
}

}  // namespace

std::vector<MeshSurface> mesh_surfaces(const TetMesh& mesh, const std::map<Label, std::string>& names,
                                       std::size_t most_bytes) {
  std::vector<MeshSurface> surfaces;
  std::set<std::string> taken;
  MeshSurface skin{"skin", {}};
  for (Interface& between : interfaces_of(mesh)) {
    if (between.outside == 0) skin.faces.insert(skin.faces.end(), between.faces.begin(), between.faces.end());
    std::string name = spoken_name(between, names);
    const bool fits = name.size() <= most_bytes && taken.insert(in_small_letters(name)).second;
    surfaces.push_back({fits ? std::move(name) : numbered_name(between), std::move(between.faces)});
  }
  if (!skin.faces.empty()) surfaces.push_back(std::move(skin));
  return surfaces;
}

std::vector<VertexId> vertices_of(const TetMesh& mesh, const std::vector<TetFace>& faces) {
  std::vector<VertexId> vertices;
  vertices.reserve(3 * faces.size());
  for (const TetFace face : faces) {
    for (const VertexId vertex : corners_of(mesh, face)) vertices.push_back(vertex);
  }
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

}  // namespace anatomesh
