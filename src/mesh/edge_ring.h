// The tetrahedra around an edge, in order.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "mesh/mesh_editor.h"

namespace anatomesh {

/// The ring of an inner edge ab: tetrahedron i has the corners a, b, link[i] and link[i + 1], in positive orientation;
/// after the last comes the first.
struct EdgeRing {
  static constexpr std::size_t kMax = 8;  ///< tetrahedra that a ring may have here

  VertexId a, b;
  std::size_t size = 0;
  std::array<VertexId, kMax> link;
  std::array<TetId, kMax> tets;

  std::span<const TetId> all_tets() const { return {tets.data(), size}; }
};

/// Fills the ring; false when the edge lies on the outer boundary or has more tetrahedra than kMax.
bool find_ring(const MeshEditor& mesh, VertexId a, VertexId b, EdgeRing& ring);

}  // namespace anatomesh
