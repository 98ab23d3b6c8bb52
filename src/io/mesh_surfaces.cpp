#include "io/mesh_surfaces.h"

#include <utility>

#include "base/sort_and_unify.h"
#include "io/element_nodes.h"
#include "io/interface_names.h"

namespace anatomesh {

std::vector<MeshSurface> mesh_surfaces(const TetMesh& mesh, const std::map<Label, std::string>& names,
                                       std::size_t most_bytes) {
  std::vector<MeshSurface> surfaces;
  InterfaceNames spoken(names, most_bytes);
  MeshSurface skin{"skin", {}};
  for (Interface& between : interfaces_of(mesh)) {
    if (between.outside == 0) skin.faces.insert(skin.faces.end(), between.faces.begin(), between.faces.end());
    std::string name = spoken.name_of(between.inside, between.outside);
    surfaces.push_back({std::move(name), std::move(between.faces)});
  }
  if (!skin.faces.empty()) surfaces.push_back(std::move(skin));
  return surfaces;
}

std::vector<VertexId> vertices_of(const TetMesh& mesh, const std::vector<TetFace>& faces) {
  std::vector<VertexId> vertices;
  vertices.reserve(3 * faces.size());
  for (const TetFace face : faces) {
    for (const VertexId vertex : nodes_of_face(mesh, face)) vertices.push_back(vertex);
  }
  sort_and_unify(vertices);
  return vertices;
}

}  // namespace anatomesh
