#include "anatomesh/interfaces.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "anatomesh/errors.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

// The corners of each face, so that its normal points away from the fourth corner.
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// The edge nodes of each face, in the same order.
constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceEdgeNodes = {{{1, 5, 4}, {3, 5, 2}, {0, 4, 3}, {2, 1, 0}}};

struct KeyedFace {
  std::array<VertexId, 3> key;  // ascending
  TetFace face;
};

std::vector<KeyedFace> sorted_faces(const TetMesh& mesh) {
  std::vector<KeyedFace> faces(4 * mesh.tets.size());
  parallel_for(mesh.tets.size(), [&](std::size_t t) {
    for (std::uint8_t c = 0; c < 4; ++c) {
      KeyedFace& face = faces[4 * t + c];
      face.face = {static_cast<TetId>(t), c};
      face.key = corners_of(mesh, face.face);
      std::ranges::sort(face.key);
    }
  });
  // Faces of equal corners stay in the order of their tetrahedra.
  std::ranges::stable_sort(faces, {}, &KeyedFace::key);
  return faces;
}

}  // namespace

std::array<VertexId, 3> corners_of(const TetMesh& mesh, TetFace face) {
  const auto& tet = mesh.tets[face.tet];
  const auto& corners = kFaceCorners[face.opposite];
  return {tet[corners[0]], tet[corners[1]], tet[corners[2]]};
}

std::array<VertexId, 3> edge_nodes_of(const TetMesh& mesh, TetFace face) {
  const auto& nodes = mesh.edge_nodes[face.tet];
  const auto& edges = kFaceEdgeNodes[face.opposite];
  return {nodes[edges[0]], nodes[edges[1]], nodes[edges[2]]};
}

std::vector<Interface> interfaces_of(const TetMesh& mesh) {
  if (mesh.labels.size() != mesh.tets.size()) {
    throw InvalidInput("the mesh has " + std::to_string(mesh.labels.size()) + " labels for " +
                       std::to_string(mesh.tets.size()) + " tetrahedra; one for each is needed");
  }
  const std::vector<KeyedFace> faces = sorted_faces(mesh);
  std::map<std::pair<Label, Label>, std::vector<TetFace>> found;
  for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    while (end < faces.size() && faces[end].key == faces[begin].key) ++end;
    if (end - begin == 2) {
      TetFace inside = faces[begin].face, outside = faces[begin + 1].face;
      if (mesh.labels[inside.tet] == mesh.labels[outside.tet]) continue;
      if (mesh.labels[outside.tet] < mesh.labels[inside.tet]) std::swap(inside, outside);
      found[{mesh.labels[inside.tet], mesh.labels[outside.tet]}].push_back(inside);
      continue;
    }
    for (std::size_t i = begin; i < end; ++i) found[{mesh.labels[faces[i].face.tet], 0}].push_back(faces[i].face);
  }
  std::vector<Interface> interfaces;
  for (auto& [labels, list] : found) {
    std::ranges::sort(list, {}, [](TetFace f) { return std::pair(f.tet, f.opposite); });
    interfaces.push_back({labels.first, labels.second, std::move(list)});
  }
  return interfaces;
}

}  // namespace anatomesh
