#include "lattice/clean_labels.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "mesh/adjacency.h"

namespace anatomesh {
namespace {

constexpr int kRounds = 3;
constexpr std::uint64_t kMinTets = 24;

// The tetrahedron behind the face of t opposite to its corner n, or t itself at the mesh's border.
TetId behind_face(const TissueMesh& mesh, const VertexLists<TetId>& tets_of_vertex, TetId t, std::size_t n) {
  const auto& tet = mesh.tets[t];
  const auto has = [&](TetId other, VertexId v) {
    return std::find(mesh.tets[other].begin(), mesh.tets[other].end(), v) != mesh.tets[other].end();
  };
  for (const TetId other : tets_of_vertex[tet[(n + 1) % 4]]) {
    if (other != t && has(other, tet[(n + 2) % 4]) && has(other, tet[(n + 3) % 4])) return other;
  }
  return t;
}

// Those behind all faces; nothing where two of them lead to its own tissue, as then it keeps that.
std::optional<std::array<TetId, 4>> behind_faces(const TissueMesh& mesh, const VertexLists<TetId>& tets_of_vertex,
                                                 TetId t) {
  std::array<TetId, 4> behind;
  int own = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    behind[n] = behind_face(mesh, tets_of_vertex, t, n);
    own += mesh.tissues[behind[n]] == mesh.tissues[t];
    if (own == 2) return {};
  }
  return behind;
}

// Tissue that t should take, its own if none.
TissueId majority_behind_faces(const TissueMesh& mesh, const std::array<TetId, 4>& behind, TetId t) {
  const TissueId own = mesh.tissues[t];
  std::array<TissueId, 4> tissues;
  for (std::size_t n = 0; n < 4; ++n) tissues[n] = mesh.tissues[behind[n]];
  std::sort(tissues.begin(), tissues.end());
  TissueId best = own;
  std::ptrdiff_t most = 0;
  for (const TissueId tissue : tissues) {
    const auto faces = std::count(tissues.begin(), tissues.end(), tissue);
    if (tissue != own && faces > most) best = tissue, most = faces;
  }
  const bool cut_off = std::count(tissues.begin(), tissues.end(), own) == 0;
  return most >= 3 || cut_off ? best : own;
}

// By vertex: whether tetrahedra of two tissues meet there.
std::vector<char> find_interface(const VertexLists<TetId>& tets_of_vertex, const std::vector<TissueId>& tissues) {
  std::vector<char> on_interface(tets_of_vertex.size());
  parallel_for(on_interface.size(), [&](std::size_t v) {
    const auto tets = tets_of_vertex[v];
    on_interface[v] = std::ranges::any_of(tets, [&](TetId t) { return tissues[t] != tissues[tets[0]]; });
  });
  return on_interface;
}

}  // namespace

void clean_labels(TissueMesh& mesh, const std::function<bool(TetId)>& may_change) {
  const auto tets_of_vertex = tets_of_vertices(mesh.points_mm.size(), mesh.tets);
  std::vector<std::uint64_t> tets_of_tissue;
  for (const TissueId tissue : mesh.tissues) {
    if (tissue >= tets_of_tissue.size()) tets_of_tissue.resize(tissue + 1u);
    ++tets_of_tissue[tissue];
  }
  // Whether a tetrahedron has not been looked at since it, or one behind its faces, was relabelled.
  std::vector<char> open(mesh.tets.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<char> on_interface = find_interface(tets_of_vertex, mesh.tissues);
    std::vector<char> candidate(mesh.tets.size());
    parallel_for(mesh.tets.size(), [&](std::size_t t) {
      candidate[t] = std::ranges::all_of(mesh.tets[t], [&](VertexId v) { return on_interface[v]; }) &&
                     may_change(static_cast<TetId>(t));
    });
    bool changed = false;
    for (TetId t = 0; t < mesh.tets.size(); ++t) {
      if (!candidate[t] || !open[t] || tets_of_tissue[mesh.tissues[t]] <= kMinTets) continue;
      open[t] = 0;
      const auto behind = behind_faces(mesh, tets_of_vertex, t);
      const TissueId tissue = behind ? majority_behind_faces(mesh, *behind, t) : mesh.tissues[t];
      if (tissue == mesh.tissues[t]) continue;
      --tets_of_tissue[mesh.tissues[t]];
      ++tets_of_tissue[tissue];
      mesh.tissues[t] = tissue;
      for (const TetId other : *behind) open[other] = 1;
      open[t] = 1;
      changed = true;
    }
    if (!changed) return;
  }
}

}  // namespace anatomesh
