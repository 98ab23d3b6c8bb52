// Rounds of refinement and deformation.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "anatomesh/options.h"
#include "base/stage.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "pipeline/final_fidelity.h"
#include "pipeline/surface_sizes.h"

namespace anatomesh {

/// A deformed mesh and its fidelity, by tissue.
struct DeformedMesh {
  TissueMesh mesh;                          ///< with its cushion
  TissueMesh beyond;                        ///< the background around that, where the plan asks for it
  std::vector<std::uint8_t> voxel_weights;  ///< of the surface field, in that case
  std::vector<Fidelity> lattice;            ///< of the lattice it was deformed from
  MeshFidelity final;                       ///< of the mesh itself
  double root_mm = 0;                       ///< spacing of that lattice's root
};

/// Refines the lattice and deforms it. With a fidelity judged on the final mesh: refines it again where the deformed
/// mesh has wrong voxels, and deforms that, until each tissue has the fidelity wanted (F by tissue, [0] unused) or the
/// lattice is as fine as it may become. Every round starts from the undeformed lattice, with its labels and the
/// voxels of its tetrahedra as they are: vertices that were dragged along with a coarse surface were measured to need
/// three times the elements for the same fidelity.
/// stage_done(name) is called after each step. Throws InvalidInput (lattice too large for its coordinates), Cancelled.
DeformedMesh refine_and_deform(const TissueImage& image, const LatticePlan& plan, const SurfaceSizes::Range& range,
                               const Options& options, const Stage& stage,
                               const std::function<void(std::string)>& stage_done);

}  // namespace anatomesh
