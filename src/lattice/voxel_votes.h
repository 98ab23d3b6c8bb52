// Which voxels each tetrahedron of the lattice holds, and the label that they vote for.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "image/tissue_image.h"
#include "lattice/red_green.h"

namespace anatomesh {

/// Voxels and label of one tetrahedron of the lattice (or of a green part of one).
struct Vote {
  std::uint32_t count = 0;  ///< voxels inside
  std::uint32_t hits = 0;   ///< of them, those with the tissue it takes
  TissueId tissue = 0;
  bool pure = true;  ///< all voxels inside carry the tissue it takes
};

/// Keeps, for every tetrahedron that was not inside one large pure tetrahedron, the list of its voxels. The lists
/// of the children share the place of their parent's, so memory is 4 bytes a voxel at any depth.
class VoxelVotes {
 public:
  /// origin_mm: lattice point (0, 0, 0) in the image's frame; unit_mm: a quarter of the coarsest spacing.
  VoxelVotes(const TissueImage& image, const RedGreenLattice& lattice, Vec3 origin_mm, double unit_mm);

  /// Hands the voxels of newly refined tetrahedra to their children. Parents before children.
  void descend(const std::vector<TetRef>& refined);

  /// From now on the children of a tetrahedron know their voxels, though it is pure and large or inside such a one. For
  /// leaves whose label a repair may change. Returns the tetrahedra that have got to know their voxels so.
  std::vector<TetRef> keep_voxels(TetRef t);

  const Vote& vote(TetRef t) const { return votes_[static_cast<std::size_t>(t.level)][t.slot]; }

  /// Voxels of a tetrahedron, as offsets in the image; empty for one inside a large pure one.
  std::span<const std::uint32_t> voxels(TetRef t) const;

  /// Whether its children take its label without a list of voxels: it is pure and large, or inside such a one.
  bool hands_label_down(TetRef t) const {
    const auto level = static_cast<std::size_t>(t.level);
    const Vote& v = votes_[level][t.slot];
    return v.pure && (v.count >= kInheritAbove || is_inherited(t));
  }

  /// Tissues of the voxels nearest to the corners of a tetrahedron.
  std::array<TissueId, 4> tissues_at_corners(TetRef t) const;

  /// Votes of the green parts of a leaf with split edges, in the order of green_split().
  std::array<Vote, 4> green_votes(TetRef leaf) const;

  /// Voxels of a leaf (part 0 of one without split edges) or of one of its green parts, as offsets in the image. Good
  /// until the thread's next call.
  std::span<const std::uint32_t> voxels_of_part(TetRef leaf, std::size_t part) const;

  /// The leaf among whose voxels one is, and the part. Nothing for one inside a large pure tetrahedron or outside of
  /// the lattice.
  struct Holder {
    TetRef leaf;
    int part;
  };
  std::optional<Holder> holder_of(std::uint32_t voxel) const;

  /// Voxels of a tissue in a leaf (part 0 of one without split edges) or in one of its green parts.
  std::uint32_t voxels_of(TetRef leaf, std::size_t part, TissueId tissue) const;

  /// Fewer voxels than this do not vote: the interpolated image does.
  static constexpr std::uint32_t kQuorum = 10;

 private:
  // A pure tetrahedron of at least this many voxels hands its label down without its voxels.
  static constexpr std::uint32_t kInheritAbove = 64;
  static constexpr std::uint32_t kInherited = ~0u;  // in begin_: inside a large pure tetrahedron

  using GreenVoxels = std::array<std::vector<std::uint32_t>, 4>;

  void vote_in_roots();
  bool is_inherited(TetRef t) const { return begin_[static_cast<std::size_t>(t.level)][t.slot] == kInherited; }
  const GreenVoxels& voxels_of_green_parts(TetRef leaf) const;
  void hand_down(TetRef parent);
  void hand_down_again(TetRef parent, std::vector<TetRef>& renewed);
  Vec3 position(std::uint32_t voxel, int level) const;
  std::pair<TissueId, std::uint32_t> most_frequent(std::span<const std::uint32_t> voxels) const;
  template <class Corners>
  Vote count_votes(std::span<const std::uint32_t> voxels, const Corners& corners) const;
  std::optional<TissueId> only_tissue(const std::array<int, 3>& low, const std::array<int, 3>& high) const;
  TissueId interpolated_tissue(const std::array<Vec3, 4>& corners) const;
  std::array<Vec3, 4> corners_in_voxels(TetRef t) const;
  Vec3 to_voxel_index(LatticePoint point, int level) const;

  const TissueImage& image_;
  const RedGreenLattice& lattice_;
  std::array<std::vector<double>, 3> position_;  // of voxel centres along each axis, in units of level 0
  double rows_per_voxel_, layers_per_row_;
  Vec3 index_per_unit_, index_of_origin_;          // lattice point of level 0 -> voxel index
  std::vector<std::uint32_t> order_;               // all voxels of the crop, grouped by tetrahedron
  std::vector<std::vector<std::uint32_t>> begin_;  // by level and slot: first place in order_
  std::vector<std::vector<Vote>> votes_;           // by level and slot
  std::uint64_t state_ = 0;                        // another one, unique, after each change
};

}  // namespace anatomesh
