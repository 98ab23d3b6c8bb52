// The nodes of elements as files list them: corners, then, where the mesh is quadratic, edge nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "anatomesh/interfaces.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// 3 or 6, 4 or 10 of them.
class ElementNodes {
 public:
  template <std::size_t count>
  void append(const std::array<VertexId, count>& nodes) {
    std::ranges::copy(nodes, nodes_.begin() + size_);
    size_ += count;
  }

  const VertexId* begin() const { return nodes_.data(); }
  const VertexId* end() const { return nodes_.data() + size_; }
  std::size_t size() const { return size_; }

 private:
  std::array<VertexId, 10> nodes_ = {};
  std::size_t size_ = 0;
};

/// How files list the edge nodes of a tetrahedron: the n-th of the file is the one at order[n] of kEdgeNodeCorners.
using EdgeNodeOrder = std::array<std::size_t, 6>;

/// As VTK, Abaqus, Nastran, FEBio and MEDIT have them.
inline constexpr EdgeNodeOrder kUsualOrder = {0, 1, 2, 3, 4, 5};

inline ElementNodes nodes_of_tet(const TetMesh& mesh, std::size_t tet, const EdgeNodeOrder& order = kUsualOrder) {
  ElementNodes nodes;
  nodes.append(mesh.tets[tet]);
  if (mesh.edge_nodes.empty()) return nodes;
  std::array<VertexId, 6> edge_nodes;
  for (std::size_t n = 0; n < 6; ++n) edge_nodes[n] = mesh.edge_nodes[tet][order[n]];
  nodes.append(edge_nodes);
  return nodes;
}

/// Anticlockwise as seen from outside: see corners_of() and edge_nodes_of().
inline ElementNodes nodes_of_face(const TetMesh& mesh, TetFace face) {
  ElementNodes nodes;
  nodes.append(corners_of(mesh, face));
  if (!mesh.edge_nodes.empty()) nodes.append(edge_nodes_of(mesh, face));
  return nodes;
}

inline bool is_quadratic(const TetMesh& mesh) { return !mesh.edge_nodes.empty(); }

/// How many nodes its tetrahedra have.
inline std::size_t nodes_per_tet(const TetMesh& mesh) { return is_quadratic(mesh) ? 10 : 4; }

}  // namespace anatomesh
