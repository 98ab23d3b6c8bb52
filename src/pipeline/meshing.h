// Meshing of a whole image, with what later updates of the mesh need.
#pragma once

#include <span>
#include <vector>

#include "anatomesh/image_to_mesh.h"
#include "image/tissue_image.h"
#include "pipeline/rounds.h"

namespace anatomesh {

struct Meshing {
  Result result;
  TissueImage image;
  DeformedMesh deformed;  ///< in the image's own frame
};

/// The fidelity asked for, by tissue. labels: those of the image, ascending.
std::vector<double> wanted_fidelity(const LatticeOptions& options, const std::vector<Label>& labels);

/// image_to_mesh() without the limit of threads, of options that have been checked. keeps_background: fills in
/// deformed.beyond.
Meshing mesh_image(const LabelImage& image, const Options& options, bool keeps_background, const Progress& progress);

/// Fills in the tissues, and adds warnings about them, of the result. wanted: F by tissue.
void describe_result(Meshing& made, std::span<const double> wanted);

}  // namespace anatomesh
