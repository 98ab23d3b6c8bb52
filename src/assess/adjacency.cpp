#include "assess/adjacency.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

/// Face of a tetrahedron, listed at the smallest of its vertices.
struct HalfFace {
  VertexId middle, largest;
  TetId tet;
  std::uint8_t corner;  ///< opposite the face

  bool same_face(const HalfFace& o) const { return middle == o.middle && largest == o.largest; }
  bool operator<(const HalfFace& o) const {
    return std::tie(middle, largest, tet, corner) < std::tie(o.middle, o.largest, o.tet, o.corner);
  }
};

/// Faces with v as their smallest vertex, equal ones side by side.
void faces_above(VertexId v, const TissueMesh& mesh, const VertexStars& stars, std::vector<HalfFace>& out) {
  out.clear();
  for (const TetId t : stars.of(v)) {
    const auto& tet = mesh.tets[t];
    for (std::uint8_t k = 0; k < 4; ++k) {
      std::array<VertexId, 3> face = {tet[(k + 1u) % 4], tet[(k + 2u) % 4], tet[(k + 3u) % 4]};
      std::sort(face.begin(), face.end());
      if (face[0] == v && tet[k] != v) out.push_back({face[1], face[2], t, k});
    }
  }
  std::sort(out.begin(), out.end());
}

struct FaceCounts {
  std::uint64_t faces = 0, outer = 0, crowded = 0;
};

/// Enters what the sorted half faces of one vertex say.
void match(std::span<const HalfFace> halves, std::vector<std::array<TetId, 4>>& across, FaceCounts& counts) {
  for (std::size_t i = 0; i < halves.size();) {
    std::size_t end = i + 1;
    while (end < halves.size() && halves[end].same_face(halves[i])) ++end;
    ++counts.faces;
    if (end == i + 1) {
      ++counts.outer;
    } else {
      across[halves[i].tet][halves[i].corner] = halves[i + 1].tet;
      across[halves[i + 1].tet][halves[i + 1].corner] = halves[i].tet;
    }
    if (end > i + 2) ++counts.crowded;
    for (std::size_t j = i + 2; j < end; ++j) across[halves[j].tet][halves[j].corner] = kCrowded;
    i = end;
  }
}

/// Grain of loops over n items that keep a table a block: at most 64 blocks.
std::size_t coarse_grain(std::size_t n) { return std::max<std::size_t>(4096, n / 64 + 1); }

void add(Skeleton& to, const Skeleton& from) {
  to.vertices += from.vertices;
  to.edges += from.edges;
  to.edge_length_mm += from.edge_length_mm;
}

/// Counts vertex v and its edges to vertices above it, for every tissue that has them and for all.
void count_at_vertex(VertexId v, const TissueMesh& mesh, const VertexStars& stars,
                     std::vector<std::pair<VertexId, Tissue>>& ends, std::vector<Skeleton>& counts) {
  if (stars.of(v).empty()) return;
  ends.clear();  // v itself stands for the vertex
  for (const TetId t : stars.of(v)) {
    for (const VertexId w : mesh.tets[t]) {
      if (w >= v) ends.emplace_back(w, mesh.tissue_of[t]);
    }
  }
  sort_and_unify(ends);
  const auto enter = [&](VertexId w, Skeleton& s) {
    if (w == v) {
      ++s.vertices;
    } else {
      ++s.edges;
      s.edge_length_mm += norm(mesh.points_mm[w] - mesh.points_mm[v]);
    }
  };
  for (std::size_t i = 0; i < ends.size(); ++i) {
    enter(ends[i].first, counts[ends[i].second]);
    if (i == 0 || ends[i].first != ends[i - 1].first) enter(ends[i].first, counts.back());
  }
}

}  // namespace

VertexStars make_vertex_stars(const TissueMesh& mesh) {
  VertexStars stars;
  stars.first.assign(mesh.points_mm.size() + 1, 0);
  for (const auto& tet : mesh.tets) {
    for (const VertexId v : tet) ++stars.first[v + 1];
  }
  for (std::size_t v = 0; v < mesh.points_mm.size(); ++v) stars.first[v + 1] += stars.first[v];
  std::vector<std::size_t> next(stars.first.begin(), stars.first.end() - 1);
  stars.tets.resize(4 * mesh.tets.size());
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    for (const VertexId v : mesh.tets[t]) stars.tets[next[v]++] = t;
  }
  return stars;
}

Neighbours find_neighbours(const TissueMesh& mesh, const VertexStars& stars) {
  Neighbours result;
  result.across.assign(mesh.tets.size(), {kOutside, kOutside, kOutside, kOutside});
  const std::size_t n = mesh.points_mm.size();
  const std::size_t grain = coarse_grain(n);
  std::vector<FaceCounts> counts((n + grain - 1) / grain);
  parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<HalfFace> halves;
    FaceCounts block;
    for (std::size_t v = begin; v < end; ++v) {
      faces_above(static_cast<VertexId>(v), mesh, stars, halves);
      match(halves, result.across, block);
    }
    counts[begin / grain] = block;
  });
  for (const FaceCounts& c : counts) {
    result.faces += c.faces;
    result.outer_faces += c.outer;
    result.crowded_faces += c.crowded;
  }
  return result;
}

std::vector<Skeleton> find_skeletons(const TissueMesh& mesh, const VertexStars& stars) {
  const std::size_t n = mesh.points_mm.size();
  const std::size_t grain = coarse_grain(n);
  std::vector<std::vector<Skeleton>> blocks((n + grain - 1) / grain);
  parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
    auto& counts = blocks[begin / grain];
    counts.resize(mesh.tissue_count() + 1);
    std::vector<std::pair<VertexId, Tissue>> ends;
    for (std::size_t v = begin; v < end; ++v) count_at_vertex(static_cast<VertexId>(v), mesh, stars, ends, counts);
  });
  std::vector<Skeleton> sum(mesh.tissue_count() + 1);
  for (const auto& counts : blocks) {
    for (std::size_t t = 0; t < sum.size(); ++t) add(sum[t], counts[t]);
  }
  return sum;
}

void edges_above(VertexId v, const TissueMesh& mesh, const VertexStars& stars, std::vector<VertexId>& ends) {
  ends.clear();
  for (const TetId t : stars.of(v)) {
    for (const VertexId w : mesh.tets[t]) {
      if (w > v) ends.push_back(w);
    }
  }
  sort_and_unify(ends);
}

std::vector<std::uint64_t> count_components(const TissueMesh& mesh, const Neighbours& neighbours) {
  DisjointSets within(mesh.tets.size()), all(mesh.tets.size());
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    for (const TetId u : neighbours.across[t]) {
      if (u >= kCrowded || u < t) continue;
      all.join(t, u);
      if (mesh.tissue_of[t] == mesh.tissue_of[u]) within.join(t, u);
    }
  }
  std::vector<std::uint64_t> components(mesh.tissue_count() + 1, 0);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    if (within.is_root(t)) ++components[mesh.tissue_of[t]];
  }
  components.back() = all.count_sets();
  return components;
}

}  // namespace anatomesh::assess_detail
