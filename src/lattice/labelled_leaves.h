// The leaves of the lattice with their labels: votes of their voxels, or decisions of a repair, which stay.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lattice/red_green.h"
#include "lattice/voxel_votes.h"

namespace anatomesh {

/// A leaf and the votes of its parts: one, or those of its green split.
struct LabelledLeaf {
  TetRef tet;
  std::uint8_t split_edges = 0;
  bool decided = false;    ///< a repair gave some part its tissue, which is then not that of the vote
  bool fresh = true;       ///< it, or its split, was not there before the last refinement
  bool recounted = false;  ///< it stayed, but voxels have become known that were inside a large pure tetrahedron
  bool revote = false;     ///< what it is refined into votes, even where all else inherits
  bool gone = false;       ///< it was refined by the last replacements: no leaf any more
  std::array<Vote, 4> votes;

  const GreenSplit& split() const { return green_split(split_edges); }
};

/// Where new leaves, made by refinement, take their labels from.
enum class NewLabels {
  vote,    ///< their voxels
  inherit  ///< the place in the old leaf that their centre lies in: tissues keep their shape
};

class LabelledLeaves {
 public:
  LabelledLeaves(const RedGreenLattice& lattice, const VoxelVotes& votes) : lattice_(lattice), votes_(votes) {}

  const std::vector<LabelledLeaf>& list() const { return leaves_; }

  /// Lists the leaves of the lattice as it is now. Those that were there before keep their labels; decided ones do
  /// so, by the centres of their parts, also when more of their edges are split now.
  void collect(NewLabels new_labels);

  /// As collect(NewLabels::inherit), but leaves keep their places: those that are gone stay in the list until it is
  /// collected, new ones come last. Returns the places of leaves that are gone, new, or may have changed: those of
  /// `renewed` tetrahedra have got to know their voxels. Cost: by what has changed.
  std::vector<std::uint32_t> replace(std::span<const TetRef> refined, std::span<const TetRef> renewed);

  /// Lets what a leaf is refined into next vote, and forget what was decided.
  void revote(std::size_t leaf) { leaves_[leaf].revote = true; }

  /// Gives a part of a leaf a tissue, from now on. Returns whether it had another one.
  bool decide(std::size_t leaf, std::uint32_t part, TissueId tissue);

 private:
  static constexpr std::uint32_t kNone = ~0u;
  using Places = std::vector<std::vector<std::uint32_t>>;  // of leaves, by level and slot

  std::vector<std::uint32_t> touched_places(std::span<const TetRef> refined, std::span<const TetRef> renewed) const;
  std::uint32_t place_of(TetRef t) const;
  void note_places(std::size_t first);
  LabelledLeaf labelled(TetRef tet, const std::vector<LabelledLeaf>& old, NewLabels how) const;
  static std::uint32_t counted(const LabelledLeaf& leaf);
  void recount(LabelledLeaf& leaf) const;
  std::array<Vote, 4> fresh_votes(const LabelledLeaf& leaf) const;
  void inherit(LabelledLeaf& leaf, const LabelledLeaf& from) const;
  void give(LabelledLeaf& leaf, std::uint32_t part, TissueId tissue) const;

  const RedGreenLattice& lattice_;
  const VoxelVotes& votes_;
  std::vector<LabelledLeaf> leaves_;
  std::vector<LabelledLeaf> old_;  // of the last collection: their memory is used again
  Places places_;
};

}  // namespace anatomesh
