#include "lattice/labelled_leaves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/sort_and_unify.h"

namespace anatomesh {

void LabelledLeaves::collect(NewLabels new_labels) {
  std::swap(leaves_, old_);
  const std::vector<TetRef> tets = lattice_.leaves();
  leaves_.resize(tets.size());
  parallel_for(tets.size(), [&](std::size_t i) { leaves_[i] = labelled(tets[i], old_, new_labels); });
  for (std::vector<std::uint32_t>& places : places_) std::ranges::fill(places, kNone);
  note_places(0);
}

std::vector<std::uint32_t> LabelledLeaves::replace(std::span<const TetRef> refined, std::span<const TetRef> renewed) {
  old_ = {};
  std::vector<std::uint32_t> touched = touched_places(refined, renewed);
  const std::size_t first = leaves_.size();
  for (const TetRef t : refined) {
    for (const TetRef child : lattice_.children(t)) {
      if (!lattice_.is_leaf(child)) continue;
      touched.push_back(static_cast<std::uint32_t>(leaves_.size()));
      leaves_.emplace_back().tet = child;
    }
  }
  std::vector<LabelledLeaf> made(touched.size());
  parallel_for(made.size(), [&](std::size_t i) {
    made[i] = leaves_[touched[i]];
    made[i].gone = !lattice_.is_leaf(made[i].tet);
    if (!made[i].gone) made[i] = labelled(made[i].tet, leaves_, NewLabels::inherit);
  });
  for (std::size_t i = 0; i < touched.size(); ++i) leaves_[touched[i]] = made[i];
  note_places(first);
  return touched;
}

// Of the leaves that are gone or may have changed, in ascending order.
std::vector<std::uint32_t> LabelledLeaves::touched_places(std::span<const TetRef> refined,
                                                          std::span<const TetRef> renewed) const {
  std::vector<std::uint32_t> touched;
  for (const std::span<const TetRef> tets : {refined, std::span<const TetRef>(lattice_.resplit()), renewed}) {
    for (const TetRef t : tets) {
      const std::uint32_t at = place_of(t);
      if (at != kNone && !leaves_[at].gone) touched.push_back(at);
    }
  }
  sort_and_unify(touched);
  return touched;
}

// Where a leaf is, or was, in the list; kNone for what has never been in it.
std::uint32_t LabelledLeaves::place_of(TetRef t) const {
  const auto level = static_cast<std::size_t>(t.level);
  return level < places_.size() && t.slot < places_[level].size() ? places_[level][t.slot] : kNone;
}

// Of the leaves from the first on.
void LabelledLeaves::note_places(std::size_t first) {
  places_.resize(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; level <= lattice_.max_level(); ++level)
    places_[static_cast<std::size_t>(level)].resize(lattice_.slot_count(level), kNone);
  parallel_for(leaves_.size() - first, [&](std::size_t i) {
    const TetRef t = leaves_[first + i].tet;
    places_[static_cast<std::size_t>(t.level)][t.slot] = static_cast<std::uint32_t>(first + i);
  });
}

LabelledLeaf LabelledLeaves::labelled(TetRef tet, const std::vector<LabelledLeaf>& old, NewLabels how) const {
  LabelledLeaf leaf;
  leaf.tet = tet;
  leaf.split_edges = static_cast<std::uint8_t>(lattice_.split_edges(tet));
  std::uint32_t from = place_of(tet);
  const bool stayed = from != kNone;
  if (stayed && old[from].split_edges == leaf.split_edges) {
    leaf = old[from];
    leaf.fresh = false;
    leaf.recounted = counted(leaf) != votes_.vote(tet).count;
    if (leaf.recounted) recount(leaf);
    return leaf;
  }
  leaf.votes = fresh_votes(leaf);
  if (how == NewLabels::inherit) {
    TetRef ancestor = tet;
    while (from == kNone && ancestor.level > 0) {
      lattice_.find(ancestor.level - 1, bcc_parent(lattice_.barycentre(ancestor)), ancestor);
      from = place_of(ancestor);
    }
    if (from != kNone && !old[from].revote) inherit(leaf, old[from]);
  } else if (stayed && old[from].decided) {
    inherit(leaf, old[from]);
  }
  return leaf;
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

bool LabelledLeaves::decide(std::size_t leaf, std::uint32_t part, TissueId tissue) {
  if (leaves_[leaf].votes[part].tissue == tissue) return false;
  give(leaves_[leaf], part, tissue);
  leaves_[leaf].decided = true;
  return true;
}

}  // namespace anatomesh
