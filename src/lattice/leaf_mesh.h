// The leaves of the lattice and their green parts as a conforming mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "lattice/labelled_leaves.h"
#include "lattice/lattice_point_map.h"
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
  std::vector<LatticePoint> points;  ///< of the vertices, in units of the finest level
  std::vector<Origin> origins;       ///< of the tetrahedra
};

/// Makes the mesh again and again while the lattice is refined: vertices keep their numbers, and the tetrahedra of
/// leaves that stayed are not made anew.
class LeafMesher {
 public:
  /// origin_mm: lattice point (0, 0, 0) in the image's frame; unit_mm: a quarter of the coarsest spacing.
  LeafMesher(const RedGreenLattice& lattice, const VoxelVotes& votes, Vec3 origin_mm, double unit_mm)
      : lattice_(lattice), votes_(votes), origin_mm_(origin_mm), unit_mm_(unit_mm) {}

  LeafMesh mesh(const std::vector<LabelledLeaf>& leaves);

 private:
  using Tets = std::vector<std::array<VertexId, 4>>;
  struct Place {
    std::uint32_t first_tet = ~0u;
    std::uint8_t split_edges = 0;
  };

  void add(const LabelledLeaf& leaf, bool bulk, const Tets& old, Tets& tets);
  bool touches_near(const std::array<LatticePoint, 10>& nodes) const;

  const RedGreenLattice& lattice_;
  const VoxelVotes& votes_;
  Vec3 origin_mm_;
  double unit_mm_;
  LatticePointMap vertices_;
  std::vector<char> near_;                  // by vertex: of more than bulk background
  std::vector<std::vector<Place>> places_;  // by level and slot: where its tetrahedra are
  Tets tets_;                               // of the last mesh
};

/// The tissues, and of the background the tetrahedra that touch a tissue, these last.
TissueMesh with_cushion_only(TissueMesh mesh);

}  // namespace anatomesh
