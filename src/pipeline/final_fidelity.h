// Fidelity of the deformed mesh, and what the lattice has to refine for more of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/stage.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// How well a mesh holds the voxel centres of each tissue.
struct MeshFidelity {
  std::vector<Fidelity> tissues;         ///< F1 and F2 by tissue, [0] unused; a mesh may not bulge out of the image
  std::vector<Fidelity> inside;          ///< the same of the centres inside the original image alone
  std::vector<TissueId> tissue_in_mesh;  ///< by voxel of the image: the tissue of the mesh at its centre
};

/// Cost: a few nanoseconds a voxel and about a microsecond a tetrahedron; memory: two bytes a voxel. Throws Cancelled.
MeshFidelity measure_fidelity(const TissueMesh& mesh, const TissueImage& image, const Stage& stage);

/// Wrong voxels farther than the largest voxel spacing from all boundaries of the mesh, along the axes: cavities that
/// are filled, folds that are closed. Finer surfaces do not mend them, as there are none.
struct FarVoxels {
  std::vector<std::uint32_t> voxels;     ///< offsets in the image
  std::vector<std::uint64_t> of_tissue;  ///< how many, by tissue: those of its voxels and those that it has too many
  std::vector<Fidelity> others;          ///< fidelity of the tissues without them
};

/// Those of the tissues that `judged` names (by tissue). Cost: some nanoseconds a voxel.
FarVoxels find_far_voxels(const MeshFidelity& reached, const TissueImage& image, const std::vector<char>& judged);

/// What is missing to `wanted` (F by tissue): the wrong voxels of each tissue that falls short, those that it lacks and
/// those that it has too many. Takes reached.tissue_in_mesh.
FidelityGap find_gap(MeshFidelity& reached, const TissueImage& image, std::span<const double> wanted);

}  // namespace anatomesh
