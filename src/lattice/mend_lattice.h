// Makes the labelled lattice whole: every tissue's surface a 2-manifold, and as many pieces of each tissue as the image
// has 26-connected components of it.
#pragma once

#include "base/stage.h"
#include "image/components.h"
#include "lattice/leaf_mesh.h"

namespace anatomesh {

struct MendPlan {
  double unit_mm = 2;    ///< a quarter of the coarsest spacing
  int piece_level = 5;   ///< how far tetrahedra are refined for the sake of pieces
  bool manifold = true;  ///< whether to mend surfaces; pieces are always mended
};

/// Gives tetrahedra with a weak vote that stick out of their tissue, or are cut off from it, to their surroundings.
void clean_leaves(const VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher);

/// Mends the labels of the leaves, and refines where that takes smaller tetrahedra. Returns the lattice as it is then.
/// Where a surface is singular, the leaves around are refined, their children keep their parents' tissues, and the
/// tetrahedra that touch the singular vertices and edges then all get one tissue: what remains meets a regular
/// neighbourhood of them, so its surfaces are manifold at the rim.
LeafMesh mend_lattice(const TissueImage& image, const ImageComponents& components, RedGreenLattice& lattice,
                      VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher, const MendPlan& plan,
                      const Stage& stage);

}  // namespace anatomesh
