#include "lattice/tet_complex.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

/// A face at its lowest vertex.
struct FaceUse {
  VertexId middle, high;
  TetId tet;
  std::uint32_t corner;  ///< opposite to it
  bool operator<(const FaceUse& o) const { return std::tie(middle, high, tet) < std::tie(o.middle, o.high, o.tet); }
};

void list_faces_of_lowest_vertex(const TetComplex& complex, VertexId v, std::vector<FaceUse>& faces) {
  faces.clear();
  for (const TetId t : complex.tets_of_vertex[v]) {
    const auto& tet = complex.mesh.tets[t];
    for (std::uint32_t n = 0; n < 4; ++n) {
      std::array<VertexId, 3> face = {tet[(n + 1) % 4], tet[(n + 2) % 4], tet[(n + 3) % 4]};
      std::sort(face.begin(), face.end());
      if (face[0] == v) faces.push_back({face[1], face[2], t, n});
    }
  }
  std::sort(faces.begin(), faces.end());
}

}  // namespace

TetComplex make_complex(TissueMesh mesh) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  const auto& tets = complex.mesh.tets;
  complex.tets_of_vertex = tets_of_vertices(complex.mesh.points_mm.size(), tets);
  complex.behind.resize(tets.size());
  for (TetId t = 0; t < tets.size(); ++t) complex.behind[t].fill(t);
  parallel_for(complex.mesh.points_mm.size(), [&](std::size_t v) {
    thread_local std::vector<FaceUse> faces;
    list_faces_of_lowest_vertex(complex, static_cast<VertexId>(v), faces);
    for (std::size_t i = 1; i < faces.size(); ++i) {
      const FaceUse &a = faces[i - 1], &b = faces[i];
      if (a.middle != b.middle || a.high != b.high) continue;
      complex.behind[a.tet][a.corner] = b.tet;
      complex.behind[b.tet][b.corner] = a.tet;
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
