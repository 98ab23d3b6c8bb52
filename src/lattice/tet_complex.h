// The whole lattice as one conforming mesh, background included, with what touches what: where labels are mended.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Stays true while labels change.
struct TetComplex {
  static constexpr TetId kNone = ~0u;

  TissueMesh mesh;
  VertexLists<TetId> tets_of_vertex;
  /// behind[t][n]: the tetrahedron behind the face of t opposite to its corner n, or t itself at the mesh's border.
  std::vector<std::array<TetId, 4>> behind;
  /// Of a part of a mesh: pairs of tetrahedra that hang together beyond it as long as they have the same tissue.
  std::vector<std::array<TetId, 2>> joined_beyond;

  TissueId tissue(TetId t) const { return mesh.tissues[t]; }
};

/// Cost: linear, about 0.1 us a tetrahedron.
TetComplex make_complex(TissueMesh mesh);

/// The same of a mesh that has most of its tetrahedra from another: tetrahedron t is from[t] of that one, or kNone;
/// vertices have kept their numbers. Cost: linear, but little where nothing has changed.
TetComplex remake_complex(const TetComplex& before, TissueMesh mesh, std::span<const TetId> from);

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
