#include "lattice/labelled_leaves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace anatomesh {

void LabelledLeaves::collect(NewLabels new_labels) {
  const std::vector<LabelledLeaf> old = std::exchange(leaves_, {});
  Places places(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; !old.empty() && level <= lattice_.max_level(); ++level)
    places[static_cast<std::size_t>(level)].assign(lattice_.slot_count(level), kNone);
  parallel_for(old.size(), [&](std::size_t i) {
    places[static_cast<std::size_t>(old[i].tet.level)][old[i].tet.slot] = static_cast<std::uint32_t>(i);
  });
  const std::vector<TetRef> tets = lattice_.leaves();
  leaves_.resize(tets.size());
  parallel_for(tets.size(), [&](std::size_t i) {
    leaves_[i].tet = tets[i];
    leaves_[i].split_edges = static_cast<std::uint8_t>(lattice_.split_edges(tets[i]));
    label(leaves_[i], old, places, new_labels);
  });
}

void LabelledLeaves::label(LabelledLeaf& leaf, const std::vector<LabelledLeaf>& old, const Places& places,
                           NewLabels how) const {
  const auto place = [&](TetRef t) { return old.empty() ? kNone : places[static_cast<std::size_t>(t.level)][t.slot]; };
  std::uint32_t from = place(leaf.tet);
  const bool stayed = from != kNone;
  if (stayed && old[from].split_edges == leaf.split_edges) {
    leaf = old[from];
    leaf.fresh = false;
    leaf.recounted = counted(leaf) != votes_.vote(leaf.tet).count;
    if (leaf.recounted) recount(leaf);
    return;
  }
  leaf.votes = fresh_votes(leaf);
  if (how == NewLabels::inherit) {
    TetRef ancestor = leaf.tet;
    while (from == kNone && ancestor.level > 0) {
      lattice_.find(ancestor.level - 1, bcc_parent(lattice_.barycentre(ancestor)), ancestor);
      from = place(ancestor);
    }
    if (from != kNone && !old[from].revote) inherit(leaf, old[from]);
  } else if (stayed && old[from].decided) {
    inherit(leaf, old[from]);
  }
}

// Voxels that its parts know of: none while it is inside a large pure tetrahedron.
std::uint32_t LabelledLeaves::counted(const LabelledLeaf& leaf) {
  std::uint32_t count = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(leaf.split().count); ++c) count += leaf.votes[c].count;
  return count;
}

void LabelledLeaves::recount(LabelledLeaf& leaf) const {
  const std::array<Vote, 4> before = leaf.votes;
  leaf.votes = fresh_votes(leaf);
  for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(leaf.split().count); ++c) give(leaf, c, before[c].tissue);
}

std::array<Vote, 4> LabelledLeaves::fresh_votes(const LabelledLeaf& leaf) const {
  if (leaf.split_edges == 0) return {votes_.vote(leaf.tet)};
  return votes_.green_votes(leaf.tet);
}

void LabelledLeaves::inherit(LabelledLeaf& leaf, const LabelledLeaf& from) const {
  const LatticePoint b = lattice_.barycentre(leaf.tet), old = lattice_.barycentre(from.tet);
  const auto vertices = bcc_vertices(b);
  const double scale = std::ldexp(0.25, from.tet.level - leaf.tet.level);
  leaf.decided = true;
  for (std::uint32_t part = 0; part < static_cast<std::uint32_t>(leaf.split().count); ++part) {
    Vec3 centre;
    for (const std::size_t node : leaf.split().tets[part]) {
      const LatticePoint p = node < 4 ? vertices[node] : bcc_edge_midpoint(b, static_cast<int>(node - 4));
      for (std::size_t a = 0; a < 3; ++a) centre[a] += scale * p[a];
    }
    const int old_part =
        from.split_edges == 0 ? 0 : green_child_at(from.split_edges, bcc_barycentric_times_4(old, centre));
    give(leaf, part, from.votes[static_cast<std::size_t>(old_part)].tissue);
  }
}

void LabelledLeaves::give(LabelledLeaf& leaf, std::uint32_t part, TissueId tissue) const {
  Vote& vote = leaf.votes[part];
  if (vote.tissue == tissue) return;
  vote.tissue = tissue;
  vote.hits = votes_.voxels_of(leaf.tet, part, tissue);
  vote.pure = vote.hits == vote.count;
}

void LabelledLeaves::decide(std::size_t leaf, std::uint32_t part, TissueId tissue) {
  give(leaves_[leaf], part, tissue);
  leaves_[leaf].decided = true;
}

}  // namespace anatomesh
