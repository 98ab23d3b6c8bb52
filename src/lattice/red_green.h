// Red-green refinement of the BCC lattice (Molino et al. 2003), kept conforming by a work list of the tetrahedra
// that a split edge touches.
//
// Invariant: when an edge of a level is split, every tetrahedron of that level around it exists (its
// parent has been refined) and has the edge in its mask. So a leaf's mask says all about its neighbours: a leaf
// none of whose edges are split is used as it is, one split edge, two opposite ones or the three of a
// face are made green; two edges of one face have had the third split as well, and any other pattern has
// been refined.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lattice/bcc_lattice.h"
#include "lattice/lattice_point_map.h"

namespace anatomesh {

/// A red tetrahedron: its level and its place in that level's arrays.
struct TetRef {
  int level = 0;
  std::uint32_t slot = 0;
  bool operator==(const TetRef&) const = default;
};

/// A refined lattice over root_cells cubes, from (0, 0, 0).
class RedGreenLattice {
 public:
  RedGreenLattice(std::array<std::int32_t, 3> root_cells, int max_level);

  std::array<std::int32_t, 3> root_cells() const { return root_cells_; }
  int max_level() const { return static_cast<int>(levels_.size()) - 1; }

  /// Places in the arrays of a level (12 a lattice cube that holds any; not all of them exist).
  std::size_t slot_count(int level) const { return levels_[static_cast<std::size_t>(level)].state.size(); }

  bool exists(TetRef t) const { return state(t) & kExists; }
  bool is_refined(TetRef t) const { return state(t) & kRefined; }
  bool is_leaf(TetRef t) const { return (state(t) & (kExists | kRefined)) == kExists; }
  /// Split edges of a leaf as bits, in the order of kTetEdges.
  unsigned split_edges(TetRef t) const { return state(t) & kEdges; }

  LatticePoint barycentre(TetRef t) const;
  /// The tetrahedron of a level with this barycentre. Returns false when it does not exist.
  bool find(int level, const LatticePoint& barycentre, TetRef& found) const;
  std::array<TetRef, 8> children(TetRef refined) const;

  /// Refines these tetrahedra (leaves below the last level; refined ones are passed over) and all that
  /// must follow. Returns all that were refined, parents before their children.
  std::vector<TetRef> refine(const std::vector<TetRef>& marked);

  /// Tetrahedra of which edges were split by the last refinement; some more than once.
  const std::vector<TetRef>& resplit() const { return resplit_; }

  /// All leaves, by level and slot.
  std::vector<TetRef> leaves() const;

  /// Tets that exist at a level, in the order of their making.
  std::vector<TetRef> tets_of_level(int level) const;

 private:
  static constexpr std::uint8_t kEdges = 0x3f, kRefined = 0x40, kExists = 0x80;

  struct Level {
    LatticePointMap blocks;           // lattice cubes that hold tetrahedra: 12 slots each
    std::vector<std::uint8_t> state;  // by slot
  };

  static std::uint32_t slot_of(std::uint32_t block, const LatticePoint& barycentre) {
    return block * kTetsPerCell + static_cast<std::uint32_t>(bcc_local_index(barycentre));
  }
  std::uint8_t state(TetRef t) const { return levels_[static_cast<std::size_t>(t.level)].state[t.slot]; }
  std::uint8_t& state(TetRef t) { return levels_[static_cast<std::size_t>(t.level)].state[t.slot]; }
  std::uint32_t root_block(const LatticePoint& cell) const;
  bool inside(int level, const LatticePoint& barycentre) const;
  TetRef create(int level, const LatticePoint& barycentre);
  void make_green_or_refine(TetRef t, std::vector<TetRef>& refined);
  void refine_one(TetRef t, std::vector<TetRef>& refined);
  void split_edge(int level, const LatticePoint& midpoint, std::vector<TetRef>& refined);
  TetRef require(int level, const LatticePoint& barycentre, std::vector<TetRef>& refined);

  std::array<std::int32_t, 3> root_cells_;
  std::vector<Level> levels_;
  std::vector<TetRef> pending_, resplit_;
};

/// The tetrahedra that a leaf with a green pattern falls into. Nodes 0 .. 3 are its vertices, 4 .. 9 the
/// midpoints of its edges. Children keep their parent's orientation.
struct GreenSplit {
  std::array<std::array<std::uint8_t, 4>, 4> tets;
  int count = 0;
};
extern const std::array<GreenSplit, 64> kGreenSplits;  ///< by split edges; none of patterns that are not green
inline const GreenSplit& green_split(unsigned split_edges) { return kGreenSplits[split_edges]; }

/// Whether a leaf with these split edges can be made green (or left as it is): none, one, two opposite
/// ones, or the three of a face.
inline bool is_green_pattern(unsigned split_edges) { return kGreenSplits[split_edges].count > 0; }

/// Which child of green_split(split_edges) holds a point with these barycentric coordinates (of any common
/// scale). Every point belongs to exactly one.
int green_child_at(unsigned split_edges, const std::array<double, 4>& barycentric);

}  // namespace anatomesh
