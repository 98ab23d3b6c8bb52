#include "lattice/red_green.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>

#include "base/parallel.h"

namespace anatomesh {
namespace {

// Edges of the face opposite to each vertex, as bits.
constexpr std::array<unsigned, 4> kFaceEdges = {0b110010, 0b001110, 0b101001, 0b010101};
// Pairs of opposite edges, as bits.
constexpr std::array<unsigned, 3> kOppositeEdges = {0b000011, 0b100100, 0b011000};

constexpr std::uint8_t midpoint_node(std::size_t i, std::size_t j) {
  for (std::size_t e = 0; e < 6; ++e) {
    const auto a = static_cast<std::size_t>(kTetEdges[e][0]), b = static_cast<std::size_t>(kTetEdges[e][1]);
    if ((a == i && b == j) || (a == j && b == i)) return static_cast<std::uint8_t>(4 + e);
  }
  return 0;
}

constexpr std::array<std::size_t, 3> face_vertices(std::size_t opposite) {
  std::array<std::size_t, 3> f{};
  std::size_t n = 0;
  for (std::size_t v = 0; v < 4; ++v) {
    if (v != opposite) f[n++] = v;
  }
  return f;
}

// Child 0 keeps the first end of every split edge; each split edge doubles the children.
constexpr GreenSplit split_edges_in_two(unsigned mask) {
  GreenSplit split{};
  split.tets[0] = {0, 1, 2, 3};
  split.count = 1;
  for (std::size_t e = 0; e < 6; ++e) {
    if (!(mask >> e & 1)) continue;
    const auto first = static_cast<std::size_t>(kTetEdges[e][0]), second = static_cast<std::size_t>(kTetEdges[e][1]);
    const auto n = static_cast<std::size_t>(split.count);
    for (std::size_t c = 0; c < n; ++c) {
      split.tets[n + c] = split.tets[c];
      split.tets[n + c][first] = static_cast<std::uint8_t>(4 + e);
      split.tets[c][second] = static_cast<std::uint8_t>(4 + e);
    }
    split.count *= 2;
  }
  return split;
}

// Three children at the corners of the split face, then the one on its middle triangle.
constexpr GreenSplit split_face_in_four(std::size_t opposite) {
  GreenSplit split{};
  split.count = 4;
  const auto f = face_vertices(opposite);
  split.tets[3] = {0, 1, 2, 3};
  for (std::size_t c = 0; c < 3; ++c) {
    split.tets[c] = {0, 1, 2, 3};
    for (std::size_t other = 0; other < 3; ++other) {
      if (other != c) split.tets[c][f[other]] = midpoint_node(f[c], f[other]);
    }
    split.tets[3][f[c]] = midpoint_node(f[c], f[(c + 1) % 3]);
  }
  return split;
}

// Vertex opposite to the face whose three edges are split, or 4.
constexpr std::size_t split_face(unsigned mask) {
  for (std::size_t v = 0; v < 4; ++v) {
    if (kFaceEdges[v] == mask) return v;
  }
  return 4;
}

// Where two edges of one face are split: the third one of that face; else -1.
int third_edge_of_face(unsigned mask) {
  if (std::popcount(mask) != 2) return -1;
  for (const unsigned face : kFaceEdges) {
    if ((mask & ~face) == 0) return std::countr_zero(face & ~mask);
  }
  return -1;
}

constexpr bool can_be_green(unsigned mask) {
  if (std::popcount(mask) < 2) return true;
  for (const unsigned pair : kOppositeEdges) {
    if (mask == pair) return true;
  }
  return split_face(mask) < 4;
}

constexpr std::array<GreenSplit, 64> make_green_table() {
  std::array<GreenSplit, 64> table{};
  for (unsigned mask = 0; mask < 64; ++mask) {
    if (!can_be_green(mask)) continue;
    table[mask] = split_face(mask) < 4 ? split_face_in_four(split_face(mask)) : split_edges_in_two(mask);
  }
  return table;
}

}  // namespace

constexpr std::array<GreenSplit, 64> kGreenSplits = make_green_table();

int green_child_at(unsigned mask, const std::array<double, 4>& l) {
  if (const std::size_t opposite = split_face(mask); opposite < 4) {
    const auto f = face_vertices(opposite);
    const double half = 0.5 * (l[f[0]] + l[f[1]] + l[f[2]]);
    for (std::size_t c = 0; c < 3; ++c) {
      if (l[f[c]] >= half) return static_cast<int>(c);
    }
    return 3;
  }
  int child = 0, weight = 1;
  for (std::size_t e = 0; e < 6; ++e) {
    if (!(mask >> e & 1)) continue;
    if (l[static_cast<std::size_t>(kTetEdges[e][1])] > l[static_cast<std::size_t>(kTetEdges[e][0])]) child += weight;
    weight *= 2;
  }
  return child;
}

RedGreenLattice::RedGreenLattice(std::array<std::int32_t, 3> root_cells, int max_level)
    : root_cells_(root_cells), levels_(static_cast<std::size_t>(max_level) + 1) {
  for (std::int32_t k = 0; k < root_cells[2]; ++k) {
    for (std::int32_t j = 0; j < root_cells[1]; ++j) {
      for (std::int32_t i = 0; i < root_cells[0]; ++i) {
        levels_[0].blocks.insert({i, j, k});
      }
    }
  }
  levels_[0].state.assign(levels_[0].blocks.points().size() * kTetsPerCell, kExists);
}

// The blocks of level 0 were made in this order.
std::uint32_t RedGreenLattice::root_block(const LatticePoint& cell) const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (cell[a] < 0 || cell[a] >= root_cells_[a]) return LatticePointMap::kNone;
  }
  return static_cast<std::uint32_t>(cell[0] + root_cells_[0] * (cell[1] + root_cells_[1] * cell[2]));
}

LatticePoint RedGreenLattice::barycentre(TetRef t) const {
  const Level& level = levels_[static_cast<std::size_t>(t.level)];
  return bcc_from_local(level.blocks.points()[t.slot / kTetsPerCell], static_cast<int>(t.slot % kTetsPerCell));
}

bool RedGreenLattice::find(int level, const LatticePoint& b, TetRef& found) const {
  const std::uint32_t block =
      level == 0 ? root_block(bcc_cell(b)) : levels_[static_cast<std::size_t>(level)].blocks.find(bcc_cell(b));
  if (block == LatticePointMap::kNone) return false;
  found = {level, slot_of(block, b)};
  return exists(found);
}

std::array<TetRef, 8> RedGreenLattice::children(TetRef t) const {
  std::array<TetRef, 8> refs;
  const auto barycentres = bcc_children(barycentre(t));
  for (std::size_t c = 0; c < 8; ++c) find(t.level + 1, barycentres[c], refs[c]);
  return refs;
}

std::vector<TetRef> RedGreenLattice::tets_of_level(int level) const {
  std::vector<TetRef> tets;
  for (std::uint32_t slot = 0; slot < slot_count(level); ++slot) {
    if (exists({level, slot})) tets.push_back({level, slot});
  }
  return tets;
}

std::vector<TetRef> RedGreenLattice::leaves() const {
  constexpr std::size_t kGrain = 1 << 16;
  std::vector<std::size_t> first_block = {0};  // by level
  for (const Level& level : levels_)
    first_block.push_back(first_block.back() + (level.state.size() + kGrain - 1) / kGrain);
  const auto for_each_leaf = [&](std::size_t block, auto&& visit) {
    const auto after = std::ranges::upper_bound(first_block, block);
    const auto level = static_cast<std::size_t>(after - first_block.begin() - 1);
    const std::size_t begin = (block - first_block[level]) * kGrain;
    const std::size_t end = std::min(begin + kGrain, levels_[level].state.size());
    for (std::size_t slot = begin; slot < end; ++slot) {
      const TetRef t = {static_cast<int>(level), static_cast<std::uint32_t>(slot)};
      if (is_leaf(t)) visit(t);
    }
  };
  std::vector<std::size_t> next(first_block.back() + 1, 0);
  parallel_for(
      first_block.back(), [&](std::size_t block) { for_each_leaf(block, [&](TetRef) { ++next[block + 1]; }); }, 1);
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<TetRef> leaves(next.back());
  parallel_for(
      first_block.back(),
      [&](std::size_t block) { for_each_leaf(block, [&](TetRef t) { leaves[next[block]++] = t; }); }, 1);
  return leaves;
}

// The root tetrahedron above a barycentre starts in a cube of the lattice.
bool RedGreenLattice::inside(int level, const LatticePoint& barycentre) const {
  LatticePoint b = barycentre;
  for (; level > 0; --level) b = bcc_parent(b);
  return root_block(bcc_cell(b)) != LatticePointMap::kNone;
}

TetRef RedGreenLattice::create(int level, const LatticePoint& b) {
  Level& l = levels_[static_cast<std::size_t>(level)];
  const TetRef t = {level, slot_of(l.blocks.insert(bcc_cell(b)), b)};
  l.state.resize(l.blocks.points().size() * kTetsPerCell, 0);
  state(t) |= kExists;
  return t;
}

std::vector<TetRef> RedGreenLattice::refine(const std::vector<TetRef>& marked) {
  std::vector<TetRef> refined;
  resplit_.clear();
  for (const TetRef t : marked) {
    refine_one(t, refined);
    while (!pending_.empty()) {
      const TetRef next = pending_.back();
      pending_.pop_back();
      make_green_or_refine(next, refined);
    }
  }
  return refined;
}

// Two split edges of a face need the third only, not eight children; so refinement does not run on through the
// lattice. More edges may have been split since the tetrahedron was put on the list.
void RedGreenLattice::make_green_or_refine(TetRef t, std::vector<TetRef>& refined) {
  if (is_refined(t) || is_green_pattern(split_edges(t))) return;
  if (const int third = third_edge_of_face(split_edges(t)); third >= 0) {
    split_edge(t.level, bcc_edge_midpoint(barycentre(t), third), refined);
  } else {
    refine_one(t, refined);
  }
}

void RedGreenLattice::refine_one(TetRef t, std::vector<TetRef>& refined) {
  if (is_refined(t)) return;
  assert(t.level < max_level());
  state(t) |= kRefined;
  refined.push_back(t);
  const LatticePoint b = barycentre(t);
  for (const LatticePoint& child : bcc_children(b)) create(t.level + 1, child);
  for (int e = 0; e < 6; ++e) {
    if (!(state(t) >> e & 1)) split_edge(t.level, bcc_edge_midpoint(b, e), refined);
  }
}

void RedGreenLattice::split_edge(int level, const LatticePoint& midpoint, std::vector<TetRef>& refined) {
  const BccRing ring = bcc_tets_around(midpoint);
  for (int n = 0; n < ring.count; ++n) {
    const LatticePoint& b = ring.barycentre[static_cast<std::size_t>(n)];
    TetRef t;
    if (!find(level, b, t)) {
      if (!inside(level, b)) continue;
      t = require(level, b, refined);
    }
    state(t) = static_cast<std::uint8_t>(state(t) | 1u << bcc_edge_at(b, midpoint));
    resplit_.push_back(t);
    if (!is_refined(t) && !is_green_pattern(split_edges(t))) pending_.push_back(t);
  }
}

// Refines ancestors until the tetrahedron exists.
TetRef RedGreenLattice::require(int level, const LatticePoint& b, std::vector<TetRef>& refined) {
  TetRef t;
  if (find(level, b, t)) return t;
  const TetRef parent = require(level - 1, bcc_parent(b), refined);
  refine_one(parent, refined);
  find(level, b, t);
  return t;
}

}  // namespace anatomesh
