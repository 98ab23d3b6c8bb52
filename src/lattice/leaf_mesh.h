// The leaves of the lattice and their green parts as a conforming mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lattice/labelled_leaves.h"
#include "lattice/lattice_point_map.h"
#include "lattice/tet_complex.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// All of the lattice but large background tetrahedra that touch nothing else; these last, else in the order of the
/// leaves.
struct LeafMesh {
  /// Where a tetrahedron comes from: a leaf (place in the list) and its part.
  struct Origin {
    std::uint32_t leaf, part;
  };
  TissueMesh mesh;
  std::vector<Origin> origins;  ///< of the tetrahedra
};

/// Makes the mesh again and again while the lattice is refined: vertices keep their numbers, and the tetrahedra of
/// leaves that stayed are not made anew.
class LeafMesher {
 public:
  /// origin_mm: lattice point (0, 0, 0) in the image's frame; unit_mm: a quarter of the coarsest spacing.
  LeafMesher(const RedGreenLattice& lattice, const VoxelVotes& votes, Vec3 origin_mm, double unit_mm)
      : lattice_(lattice), votes_(votes), origin_mm_(origin_mm), unit_mm_(unit_mm) {}

  /// How much is made of large background tetrahedra.
  enum class Bulk { near, all };

  LeafMesh mesh(const std::vector<LabelledLeaf>& leaves, Bulk wanted = Bulk::near);

  /// Makes the last mesh follow leaves of which some (`touched`) are gone, new, split in another way or relabelled:
  /// tetrahedra keep their numbers, new ones come last. Returns those that are no longer of the mesh, in ascending
  /// order. Cost: by what was touched, and a look at the large background that is not in the mesh.
  std::vector<TetId> update(const std::vector<LabelledLeaf>& leaves, std::span<const std::uint32_t> touched,
                            TissueMesh& mesh, std::vector<LeafMesh::Origin>& origins);

  /// The vertices, in units of the finest level.
  const LatticePointMap& vertices() const { return vertices_; }

  /// The first tetrahedron of a leaf in the last mesh, or TetComplex::kNone.
  TetId first_tet(TetRef leaf) const { return place_of(leaf).first_tet; }

 private:
  static constexpr std::uint32_t kNone = ~0u;
  using Tets = std::vector<std::array<VertexId, 4>>;
  struct Place {
    TetId first_tet = TetComplex::kNone;
    std::uint8_t split_edges = 0;
    bool bulk = false;
  };
  /// What becomes of a leaf.
  struct Entry {
    bool bulk = false, known = false, wanted = false;
    std::uint32_t first_new = kNone;  ///< of its tetrahedra among the new ones
  };

  Place& place_of(TetRef leaf) { return places_[static_cast<std::size_t>(leaf.level)][leaf.slot]; }
  const Place& place_of(TetRef leaf) const { return places_[static_cast<std::size_t>(leaf.level)][leaf.slot]; }
  void make_places();
  bool is_bulk(const LabelledLeaf& leaf) const;
  bool is_near(const LabelledLeaf& leaf) const;
  std::vector<Entry> make_entries(const std::vector<LabelledLeaf>& leaves, Bulk wanted) const;
  void want_bulk_near(const std::vector<LabelledLeaf>& leaves, std::vector<Entry>& entries) const;
  void add(const LabelledLeaf& leaf, Tets& added);
  void mark_near(const LabelledLeaf& leaf, const std::array<VertexId, 4>* tets);
  void drop(Place& place, std::vector<TetId>& dropped) const;
  void append(const std::vector<LabelledLeaf>& leaves, std::uint32_t at, TissueMesh& mesh,
              std::vector<LeafMesh::Origin>& origins);
  void append_bulk_near(const std::vector<LabelledLeaf>& leaves, TissueMesh& mesh,
                        std::vector<LeafMesh::Origin>& origins);
  LeafMesh gather(const std::vector<LabelledLeaf>& leaves, const std::vector<Entry>& entries, const Tets& added);
  void place_vertices(std::vector<Vec3>& points_mm) const;

  const RedGreenLattice& lattice_;
  const VoxelVotes& votes_;
  Vec3 origin_mm_;
  double unit_mm_;
  LatticePointMap vertices_;
  std::vector<char> near_;                  // by vertex: of more than bulk background
  std::vector<std::vector<Place>> places_;  // by level and slot: where its tetrahedra are
  Tets tets_;                               // of the last mesh
  std::vector<std::uint32_t> far_;          // leaves of large background that are not in it
};

/// The tissues, and of the background the tetrahedra that touch a tissue, these last.
TissueMesh with_cushion_only(TissueMesh mesh);

/// The rest of the background.
TissueMesh without_cushion(TissueMesh mesh);

}  // namespace anatomesh
