// The leaves of the lattice and their green parts as a conforming mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "lattice/labelled_leaves.h"
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

/// origin_mm: lattice point (0, 0, 0) in the image's frame; unit_mm: a quarter of the coarsest spacing.
LeafMesh mesh_of_leaves(const RedGreenLattice& lattice, const VoxelVotes& votes,
                        const std::vector<LabelledLeaf>& leaves, Vec3 origin_mm, double unit_mm);

/// The tissues, and of the background the tetrahedra that touch a tissue, these last.
TissueMesh with_cushion_only(TissueMesh mesh);

}  // namespace anatomesh
