// What the result says of a mesh.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "anatomesh/image_to_mesh.h"
#include "image/components.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// The mesh without its background, in the space and of the order asked for; tissue numbers become labels. Of `image`
/// only the origin and the direction count.
TetMesh finished_mesh(const TissueMesh& mesh, const TissueImage& tissues, const LabelImage& image,
                      const Options& options);

/// wanted, lattice, final: F asked for and reached, by tissue.
std::vector<TissueOutcome> describe_tissues(const TissueImage& image, std::span<const double> wanted,
                                            const std::vector<Fidelity>& lattice, const std::vector<Fidelity>& final,
                                            const TissueMesh& mesh);

// These append sentences for the user to the warnings.
void describe_losses(const std::vector<TissueOutcome>& tissues, std::vector<std::string>& warnings);
void describe_islands(const std::vector<DroppedIsland>& islands, const TissueImage& image,
                      std::vector<std::string>& warnings);
/// A tissue thinner than the lattice can lose most of its volume to the deformation: that must not pass unnoticed.
void describe_shrinkage(const TissueMesh& mesh, const TissueImage& image, std::vector<std::string>& warnings);
/// Fidelity that was asked for and is not there is said in one sentence, however many tissues lack it.
void describe_shortfall(const std::vector<TissueOutcome>& tissues, std::vector<std::string>& warnings);

}  // namespace anatomesh
