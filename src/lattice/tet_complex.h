// The whole lattice as one conforming mesh, background included, with what touches what: where labels are mended.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// The tetrahedra at each vertex, in ascending order. Lists can be replaced one by one.
class VertexStars {
 public:
  VertexStars() = default;
  explicit VertexStars(VertexLists<TetId> lists);

  std::size_t size() const { return places_.size(); }
  std::span<const TetId> operator[](std::size_t v) const {
    return {items_.data() + places_[v].begin, places_[v].count};
  }

  /// Takes some tetrahedra (ascending) out and adds others, with the numbers from `first_added` on to the last.
  void replace(std::span<const std::array<VertexId, 4>> tets, std::span<const TetId> dropped, TetId first_added,
               std::size_t vertex_count);

 private:
  struct Place {
    std::uint32_t begin = 0, count = 0;
  };
  std::vector<Place> places_;
  std::vector<TetId> items_;
};

/// Stays true while labels change.
struct TetComplex {
  static constexpr TetId kNone = ~0u;

  TissueMesh mesh;
  VertexStars tets_of_vertex;
  /// behind[t][n]: the tetrahedron behind the face of t opposite to its corner n, or t itself at the mesh's border.
  std::vector<std::array<TetId, 4>> behind;
  /// Of a part of a mesh: pairs of tetrahedra that hang together beyond it as long as they have the same tissue.
  std::vector<std::array<TetId, 2>> joined_beyond;

  TissueId tissue(TetId t) const { return mesh.tissues[t]; }
};

/// Cost: linear, about 0.1 us a tetrahedron.
TetComplex make_complex(TissueMesh mesh);

/// Makes it true again after tetrahedra, with numbers from `first_added` on, were added to its mesh in place of some
/// others (ascending). These last become background that touches nothing. Cost: by what has changed.
void replace_tets(TetComplex& complex, std::span<const TetId> dropped, TetId first_added);

/// Pieces of the tissues: tetrahedra of one tissue, each reached from each other through faces.
struct Pieces {
  static constexpr std::uint32_t kNone = ~0u;
  struct Piece {
    TissueId tissue = 0;
    std::uint32_t tets = 0;
    TetId first = 0;  ///< the lowest of them
  };
  std::vector<std::uint32_t> of_tet;  ///< by tetrahedron, kNone for background
  std::vector<Piece> list;            ///< in the order of their first tetrahedra
};
Pieces find_pieces(const TetComplex& complex);

}  // namespace anatomesh
