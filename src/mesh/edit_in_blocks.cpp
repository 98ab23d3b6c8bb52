#include "mesh/edit_in_blocks.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

using Tets = std::span<std::pair<Vec3, TetId>>;  // with the sums of their corners

std::size_t longest_side(Tets tets) {
  Vec3 low = tets.front().first, high = low;
  for (const auto& [p, t] : tets) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  const Vec3 size = high - low;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

std::array<Tets, 2> cut(Tets tets, double share) {
  const std::size_t axis = longest_side(tets);
  const auto first =
      std::clamp<std::size_t>(static_cast<std::size_t>(share * static_cast<double>(tets.size())), 1, tets.size() - 1);
  std::ranges::nth_element(tets, tets.begin() + static_cast<std::ptrdiff_t>(first), [&](const auto& a, const auto& b) {
    return a.first[axis] != b.first[axis] ? a.first[axis] < b.first[axis] : a.second < b.second;
  });
  return {tets.first(first), tets.subspan(first)};
}

std::vector<Tets> cut_into_blocks(Tets tets, const BlockCuts& cuts) {
  std::vector<Tets> blocks = {tets};
  while (std::ranges::any_of(blocks, [&](Tets b) { return b.size() > cuts.most; })) {
    std::vector<std::array<Tets, 2>> parts(blocks.size());
    parallel_for(
        blocks.size(),
        [&](std::size_t b) {
          parts[b] = blocks[b].size() > cuts.most ? cut(blocks[b], cuts.share) : std::array{blocks[b], Tets{}};
        },
        1);
    blocks.clear();
    for (const auto& two : parts) {
      for (const Tets part : two) {
        if (!part.empty()) blocks.push_back(part);
      }
    }
  }
  return blocks;
}

constexpr std::uint32_t kSeam = static_cast<std::uint32_t>(-1), kNone = static_cast<std::uint32_t>(-2);

// Which block has what.
struct Blocks {
  std::vector<std::uint32_t> begin;      // by block: its first place in `tets`, and one more
  std::vector<TetId> tets;               // of all blocks, ascending in each
  std::vector<std::uint32_t> of_vertex;  // kSeam: more than one has it

  Blocks(const TissueMesh& mesh, const BlockCuts& cuts);
  std::size_t size() const { return begin.size() - 1; }
  std::span<const TetId> tets_of(std::size_t b) const {
    return std::span(tets).subspan(begin[b], begin[b + 1] - begin[b]);
  }
};

Blocks::Blocks(const TissueMesh& mesh, const BlockCuts& cuts) : begin{0} {
  std::vector<std::pair<Vec3, TetId>> sums(mesh.tets.size());
  parallel_for(sums.size(), [&](std::size_t t) {
    Vec3 sum;
    for (const VertexId v : mesh.tets[t]) sum += mesh.points_mm[v];
    sums[t] = {sum, static_cast<TetId>(t)};
  });
  const std::vector<Tets> parts = cut_into_blocks(sums, cuts);
  std::vector<std::uint32_t> of_tet(mesh.tets.size());
  for (std::uint32_t b = 0; b < parts.size(); ++b) {
    begin.push_back(begin.back() + static_cast<std::uint32_t>(parts[b].size()));
    for (const auto& [p, t] : parts[b]) of_tet[t] = b;
  }
  tets.resize(mesh.tets.size());
  of_vertex.assign(mesh.points_mm.size(), kNone);
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    const std::uint32_t b = of_tet[t];
    tets[next[b]++] = t;
    for (const VertexId v : mesh.tets[t]) of_vertex[v] = of_vertex[v] == b || of_vertex[v] == kNone ? b : kSeam;
  }
}

// The tetrahedra of a block, with their vertices numbered anew.
struct Block {
  TissueMesh mesh;
  std::vector<VertexId> vertices;  // their numbers in the whole mesh, those on seams first

  // number: by vertex of the whole mesh, room for the new numbers of those in one block only.
  Block(const TissueMesh& whole, const Blocks& blocks, std::size_t b, std::vector<VertexId>& number);
};

Block::Block(const TissueMesh& whole, const Blocks& blocks, std::size_t b, std::vector<VertexId>& number) {
  for (const TetId t : blocks.tets_of(b)) {
    for (const VertexId v : whole.tets[t]) {
      if (blocks.of_vertex[v] == kSeam) vertices.push_back(v);
    }
  }
  sort_and_unify(vertices);
  const std::size_t seam = vertices.size();
  mesh.tets.reserve(blocks.tets_of(b).size());
  mesh.tissues.reserve(blocks.tets_of(b).size());
  for (const TetId t : blocks.tets_of(b)) {
    std::array<VertexId, 4> tet = whole.tets[t];
    for (VertexId& v : tet) {
      if (blocks.of_vertex[v] == kSeam) {
        v = static_cast<VertexId>(
            std::lower_bound(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(seam), v) -
            vertices.begin());
        continue;
      }
      if (number[v] == kNone) {
        number[v] = static_cast<VertexId>(vertices.size());
        vertices.push_back(v);
      }
      v = number[v];
    }
    mesh.tets.push_back(tet);
    mesh.tissues.push_back(whole.tissues[t]);
  }
  mesh.points_mm.reserve(vertices.size());
  for (const VertexId v : vertices) mesh.points_mm.push_back(whole.points_mm[v]);
}

}  // namespace

TissueMesh edit_in_blocks(const TissueMesh& mesh, const BlockCuts& cuts, std::vector<char>& is_due,
                          const std::function<void(MeshEditor& editor, std::span<const VertexId> vertices)>& edit) {
  const Blocks blocks(mesh, cuts);
  TissueMesh edited;
  edited.points_mm = mesh.points_mm;
  std::vector<VertexId> number(mesh.points_mm.size(), kNone);
  std::vector<TissueMesh> parts(blocks.size());
  std::vector<std::vector<VertexId>> due_at_seams(blocks.size());
  parallel_for(
      blocks.size(),
      [&](std::size_t b) {
        Block block(mesh, blocks, b, number);
        MeshEditor editor(std::move(block.mesh));
        for (VertexId v = 0; v < block.vertices.size(); ++v) {
          if (is_due[block.vertices[v]]) editor.mark(v);
        }
        edit(editor, block.vertices);
        for (VertexId v = 0; v < block.vertices.size(); ++v) {
          const VertexId w = block.vertices[v];
          if (blocks.of_vertex[w] != kSeam) {
            edited.points_mm[w] = editor.point(v);
          } else if (editor.changed_at(v) > 0) {
            due_at_seams[b].push_back(w);
          }
        }
        parts[b] = editor.living(block.vertices);
      },
      1);
  is_due.assign(is_due.size(), 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (const VertexId v : due_at_seams[b]) is_due[v] = 1;
    edited.tets.insert(edited.tets.end(), parts[b].tets.begin(), parts[b].tets.end());
    edited.tissues.insert(edited.tissues.end(), parts[b].tissues.begin(), parts[b].tissues.end());
    parts[b] = {};
  }
  return edited;
}

}  // namespace anatomesh
