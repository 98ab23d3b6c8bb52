// Labelled lattices of test images, as the deformation finds them.
#pragma once

#include "base/stage.h"
#include "lattice/built_lattice.h"
#include "mesh/adjacency.h"
#include "mesh/mesh_checks.h"

namespace anatomesh::testing {

/// A stage that nobody watches.
inline Stage quiet_stage() {
  static const Progress nobody;
  return {nobody, "test", 0, 1};
}

/// The lattice of an image (8 voxels, fidelity 0.95), with its cushion.
inline TissueMesh lattice_of(const TissueImage& image) {
  const double bcc_size_mm = 8 * (image.spacing_mm.x + image.spacing_mm.y + image.spacing_mm.z) / 3;
  return build(image, plan_for(image, bcc_size_mm, 0.95)).mesh;
}

/// The worst shape of the tissues' tetrahedra alone.
inline Shape worst_tissue_shape(const TissueMesh& mesh) {
  std::vector<Tet> tets;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.tissues[t] != 0) tets.push_back(mesh.tets[t]);
  }
  return worst_shape(mesh.points_mm, tets);
}

}  // namespace anatomesh::testing
