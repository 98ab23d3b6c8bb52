#include "lattice/tet_complex.h"

#include <algorithm>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

/// A face at its lowest vertex that waits for the tetrahedron on its other side.
struct OpenFace {
  std::uint64_t others;  ///< its other two vertices
  TetId tet;
  std::uint32_t corner;  ///< opposite to it
};

// Matches the faces whose lowest vertex is v. Both tetrahedra at a face are at v, so nothing else writes there.
void match_faces_at(TetComplex& complex, VertexId v, std::vector<OpenFace>& open) {
  open.clear();
  for (const TetId t : complex.tets_of_vertex[v]) {
    const auto& tet = complex.mesh.tets[t];
    for (std::uint32_t n = 0; n < 4; ++n) {
      const VertexId a = tet[(n + 1) % 4], b = tet[(n + 2) % 4], c = tet[(n + 3) % 4];
      if (std::min({a, b, c}) != v) continue;
      const VertexId high = std::max({a, b, c}), middle = a ^ b ^ c ^ v ^ high;
      const std::uint64_t others = std::uint64_t{middle} << 32u | high;
      const auto match = std::ranges::find(open, others, &OpenFace::others);
      if (match == open.end()) {
        open.push_back({others, t, n});
        continue;
      }
      complex.behind[t][n] = match->tet;
      complex.behind[match->tet][match->corner] = t;
      *match = open.back();
      open.pop_back();
    }
  }
  for (const OpenFace& face : open) complex.behind[face.tet][face.corner] = face.tet;
}

// The tetrahedron behind the face of t opposite to its corner n, or t.
TetId find_behind(const TetComplex& complex, TetId t, std::size_t n) {
  const auto& tet = complex.mesh.tets[t];
  const auto has = [&](TetId other, VertexId v) { return std::ranges::find(complex.mesh.tets[other], v) != complex.mesh.tets[other].end(); };
  for (const TetId other : complex.tets_of_vertex[tet[(n + 1) % 4]]) {
    if (other != t && has(other, tet[(n + 2) % 4]) && has(other, tet[(n + 3) % 4])) return other;
  }
  return t;
}

}  // namespace

TetComplex make_complex(TissueMesh mesh) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  complex.tets_of_vertex = tets_of_vertices(complex.mesh.points_mm.size(), complex.mesh.tets);
  complex.behind.resize(complex.mesh.tets.size());
  parallel_for(complex.mesh.points_mm.size(), [&](std::size_t v) {
    thread_local std::vector<OpenFace> open;
    match_faces_at(complex, static_cast<VertexId>(v), open);
  });
  return complex;
}

TetComplex remake_complex(const TetComplex& before, TissueMesh mesh, std::span<const TetId> from) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  complex.tets_of_vertex = tets_of_vertices(complex.mesh.points_mm.size(), complex.mesh.tets);
  complex.behind.resize(complex.mesh.tets.size());
  std::vector<TetId> number(before.mesh.tets.size(), TetComplex::kNone);
  parallel_for(from.size(), [&](std::size_t t) {
    if (from[t] != TetComplex::kNone) number[from[t]] = static_cast<TetId>(t);
  });
  parallel_for(from.size(), [&](std::size_t i) {
    const auto t = static_cast<TetId>(i);
    for (std::size_t n = 0; n < 4; ++n) {
      const bool had_other = from[t] != TetComplex::kNone && before.behind[from[t]][n] != from[t];
      const TetId other = had_other ? number[before.behind[from[t]][n]] : TetComplex::kNone;
      complex.behind[t][n] = other == TetComplex::kNone ? find_behind(complex, t, n) : other;
    }
  });
  return complex;
}

Pieces find_pieces(const TetComplex& complex) {
  const auto& tissues = complex.mesh.tissues;
  DisjointSets sets(tissues.size());
  for (TetId t = 0; t < tissues.size(); ++t) {
    if (tissues[t] == 0) continue;
    for (const TetId other : complex.behind[t]) {
      if (other < t && tissues[other] == tissues[t]) sets.join(t, other);
    }
  }
  Pieces pieces;
  pieces.of_tet.assign(tissues.size(), Pieces::kNone);
  for (TetId t = 0; t < tissues.size(); ++t) {
    if (tissues[t] == 0) continue;
    if (sets.is_root(t)) {  // the lowest of its piece
      pieces.of_tet[t] = static_cast<std::uint32_t>(pieces.list.size());
      pieces.list.push_back({tissues[t], 0, t});
    } else {
      pieces.of_tet[t] = pieces.of_tet[sets.root(t)];
    }
    ++pieces.list[pieces.of_tet[t]].tets;
  }
  return pieces;
}

}  // namespace anatomesh
