// Which tetrahedra share faces, and the distinct edges and vertices of every tissue.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "assess/tissue_mesh.h"

namespace anatomesh::assess_detail {

/// Tetrahedra at each vertex.
struct VertexStars {
  std::vector<std::size_t> first;  ///< of each vertex in tets, and the end
  std::vector<TetId> tets;

  std::span<const TetId> of(VertexId v) const {
    return std::span<const TetId>(tets).subspan(first[v], first[v + 1] - first[v]);
  }
};

VertexStars make_vertex_stars(const TissueMesh& mesh);

/// In place of a neighbour: the face is an outer one.
inline constexpr TetId kOutside = std::numeric_limits<TetId>::max();

/// In place of a neighbour: two other tetrahedra, earlier in the mesh, have this face already.
inline constexpr TetId kCrowded = kOutside - 1;

struct Neighbours {
  std::vector<std::array<TetId, 4>> across;  ///< the tetrahedron behind the face opposite each corner
  std::uint64_t faces = 0;                   ///< distinct ones
  std::uint64_t outer_faces = 0;
  std::uint64_t crowded_faces = 0;  ///< in more than two tetrahedra
};

/// Cost: a few hundred nanoseconds a tetrahedron.
Neighbours find_neighbours(const TissueMesh& mesh, const VertexStars& stars);

/// Distinct vertices and edges of a set of tetrahedra.
struct Skeleton {
  std::uint64_t vertices = 0;
  std::uint64_t edges = 0;
  double edge_length_mm = 0;  ///< summed over the distinct edges
};

/// Of every tissue, and of all tetrahedra as the last one.
std::vector<Skeleton> find_skeletons(const TissueMesh& mesh, const VertexStars& stars);

/// Appends to `ends` (emptied first) the ends of the distinct edges at v with a number above v, ascending.
void edges_above(VertexId v, const TissueMesh& mesh, const VertexStars& stars, std::vector<VertexId>& ends);

/// Parts connected by faces, of every tissue, and of all tetrahedra as the last one.
std::vector<std::uint64_t> count_components(const TissueMesh& mesh, const Neighbours& neighbours);

}  // namespace anatomesh::assess_detail
