#include "pipeline/mesh_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/vertices_by_point.h"

namespace anatomesh {
namespace {

constexpr auto kNone = static_cast<std::uint32_t>(-1);

std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a >= 0 ? a / b : -((b - 1 - a) / b); }

// The tetrahedra with a vertex of those chosen already.
void add_ring(const TissueMesh& whole, std::vector<char>& chosen) {
  std::vector<char> touched(whole.points_mm.size(), 0);
  for (TetId t = 0; t < chosen.size(); ++t) {
    if (!chosen[t]) continue;
    for (const VertexId v : whole.tets[t]) touched[v] = 1;
  }
  parallel_for(chosen.size(), [&](std::size_t t) {
    const auto& [a, b, c, d] = whole.tets[t];
    if (touched[a] || touched[b] || touched[c] || touched[d]) chosen[t] = 1;
  });
}

}  // namespace

IndexBox box_of(const TissueImage& image) {
  IndexBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = image.first[a];
    box.high[a] = image.first[a] + image.size[a];
  }
  return box;
}

VoxelBlocks::VoxelBlocks(const IndexBox& box) {
  constexpr std::int64_t kRoom = 16;  // blocks, to dilate
  std::size_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = floor_div(box.low[a], kSide) - kRoom;
    size_[a] = floor_div(box.high[a], kSide) + kRoom + 1 - low_[a];
    count *= static_cast<std::size_t>(size_[a]);
  }
  marked_.assign(count, 0);
}

std::size_t VoxelBlocks::place(std::int64_t i, std::int64_t j, std::int64_t k) const {
  return static_cast<std::size_t>(i + size_[0] * (j + size_[1] * k));
}

void VoxelBlocks::add(const std::array<std::int64_t, 3>& voxel) {
  std::array<std::int64_t, 3> at;
  for (std::size_t a = 0; a < 3; ++a) at[a] = floor_div(voxel[a], kSide) - low_[a];
  marked_[place(at[0], at[1], at[2])] = 1;
}

void VoxelBlocks::dilate(int blocks) {
  std::array<std::int64_t, 3> step = {1, size_[0], size_[0] * size_[1]};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<char> before = marked_;
    for (std::size_t n = 0; n < before.size(); ++n) {
      if (!before[n]) continue;
      const std::int64_t at = static_cast<std::int64_t>(n) / step[a] % size_[a];
      const std::int64_t first = std::max<std::int64_t>(-blocks, -at),
                         last = std::min<std::int64_t>(blocks, size_[a] - 1 - at);
      for (std::int64_t d = first; d <= last; ++d)
        marked_[static_cast<std::size_t>(static_cast<std::int64_t>(n) + d * step[a])] = 1;
    }
  }
}

bool VoxelBlocks::meets(Vec3 low_mm, Vec3 high_mm, Vec3 spacing_mm) const {
  std::array<std::int64_t, 3> low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto block = [&](double mm) {
      return static_cast<std::int64_t>(std::floor((mm / spacing_mm[a] + 0.5) / static_cast<double>(kSide))) - low_[a];
    };
    low[a] = std::max<std::int64_t>(0, block(low_mm[a]));
    high[a] = std::min(size_[a] - 1, block(high_mm[a]));
    if (high[a] < low[a]) return false;
  }
  for (std::int64_t k = low[2]; k <= high[2]; ++k) {
    for (std::int64_t j = low[1]; j <= high[1]; ++j) {
      const char* row = &marked_[place(0, j, k)];
      if (std::any_of(row + low[0], row + high[0] + 1, [](char m) { return m != 0; })) return true;
    }
  }
  return false;
}

std::vector<char> border_vertices(const TetComplex& complex) {
  const TissueMesh& mesh = complex.mesh;
  std::vector<char> is_border(mesh.points_mm.size(), 0);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t n = 0; n < 4; ++n) {
      if (complex.behind[t][n] != t) continue;
      for (std::size_t m = 0; m < 4; ++m) {
        if (m != n) is_border[mesh.tets[t][m]] = 1;
      }
    }
  }
  return is_border;
}

std::vector<char> border_vertices(const TissueMesh& mesh) { return border_vertices(make_complex(mesh)); }

MeshPatch take_patch(const TissueMesh& whole, const VoxelBlocks& blocks, Vec3 spacing_mm, int rings) {
  std::vector<char> chosen(whole.tets.size(), 0);
  parallel_for(chosen.size(), [&](std::size_t t) {
    Vec3 low = whole.points_mm[whole.tets[t][0]], high = low;
    for (const VertexId v : whole.tets[t]) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], whole.points_mm[v][a]);
        high[a] = std::max(high[a], whole.points_mm[v][a]);
      }
    }
    chosen[t] = blocks.meets(low, high, spacing_mm);
  });
  for (int ring = 0; ring < rings; ++ring) add_ring(whole, chosen);
  MeshPatch patch;
  std::vector<std::uint32_t> number(whole.points_mm.size(), kNone);
  for (TetId t = 0; t < chosen.size(); ++t) {
    if (!chosen[t]) continue;
    patch.tets.push_back(t);
    std::array<VertexId, 4> tet = whole.tets[t];
    for (VertexId& v : tet) {
      if (number[v] == kNone) {
        number[v] = static_cast<VertexId>(patch.vertices.size());
        patch.vertices.push_back(v);
        patch.mesh.points_mm.push_back(whole.points_mm[v]);
      }
      v = number[v];
    }
    patch.mesh.tets.push_back(tet);
    patch.mesh.tissues.push_back(whole.tissues[t]);
  }
  patch.is_border = border_vertices(patch.mesh);
  return patch;
}

std::size_t put_patch(TissueMesh& whole, const MeshPatch& patch, const TissueMesh& changed) {
  VerticesByPoint border;
  std::vector<VertexId> free;
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (patch.is_border[v]) {
      border.add(patch.mesh.points_mm[v], patch.vertices[v]);
    } else {
      free.push_back(patch.vertices[v]);
    }
  }
  std::size_t used = 0;
  std::vector<VertexId> number(changed.points_mm.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    const Vec3 p = changed.points_mm[v];
    if (const auto known = border.at(p)) {
      number[v] = *known;
    } else if (used < free.size()) {
      number[v] = free[used++];
      whole.points_mm[number[v]] = p;
    } else {
      number[v] = static_cast<VertexId>(whole.points_mm.size());
      whole.points_mm.push_back(p);
    }
  }
  for (std::size_t t = 0; t < changed.tets.size(); ++t) {
    std::array<VertexId, 4> tet = changed.tets[t];
    for (VertexId& v : tet) v = number[v];
    if (t < patch.tets.size()) {
      whole.tets[patch.tets[t]] = tet;
      whole.tissues[patch.tets[t]] = changed.tissues[t];
    } else {
      whole.tets.push_back(tet);
      whole.tissues.push_back(changed.tissues[t]);
    }
  }
  // Places that are left are taken by the last tetrahedra.
  for (std::size_t n = patch.tets.size(); n > changed.tets.size(); --n) {
    const TetId t = patch.tets[n - 1];
    whole.tets[t] = whole.tets.back();
    whole.tissues[t] = whole.tissues.back();
    whole.tets.pop_back();
    whole.tissues.pop_back();
  }
  return free.size() - used;
}

// Where surfaces are manifold, tetrahedra of one tissue at one vertex hang together.
RestPieces find_rest_pieces(const TissueMesh& whole, const MeshPatch& patch, std::vector<char> counted) {
  RestPieces rest;
  rest.closed.assign(counted.size(), 0);
  rest.counted = std::move(counted);
  std::vector<char> is_mine(whole.tets.size(), 0);
  for (const TetId t : patch.tets) is_mine[t] = 1;
  std::vector<char> seen(whole.points_mm.size()), touches(seen.size());
  for (std::size_t tissue = 1; tissue < rest.counted.size(); ++tissue) {
    if (!rest.counted[tissue]) continue;
    DisjointSets pieces(seen.size());
    std::fill(seen.begin(), seen.end(), char{0});
    std::fill(touches.begin(), touches.end(), char{0});
    for (std::size_t t = 0; t < whole.tets.size(); ++t) {
      if (whole.tissues[t] != tissue || is_mine[t]) continue;
      for (const VertexId v : whole.tets[t]) {
        seen[v] = 1;
        pieces.join(v, whole.tets[t][0]);
      }
    }
    for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
      const VertexId w = patch.vertices[v];
      if (!patch.is_border[v] || !seen[w]) continue;
      touches[pieces.root(w)] = 1;
      rest.contacts.push_back({static_cast<VertexId>(v), static_cast<TissueId>(tissue), pieces.root(w)});
    }
    for (VertexId v = 0; v < seen.size(); ++v) rest.closed[tissue] += seen[v] && pieces.is_root(v) && !touches[v];
  }
  return rest;
}

}  // namespace anatomesh
