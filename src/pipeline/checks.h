// What is refused before the work starts.
#pragma once

#include <cstddef>

#include "anatomesh/image_to_mesh.h"
#include "image/tissue_image.h"

namespace anatomesh {

/// Options with the sizes that were 0 set from the image's spacing. Throws InvalidOption when min_size_mm is above
/// bcc_size_mm.
Options with_sizes_filled_in(const Options& options, const LabelImage& image);

/// Throws InvalidOption for a label in `labels`, `fidelity_label` or `material` that the image does not have.
void check_labels_exist(const Options& options, const TissueImage& tissues);

/// How many tetrahedra of the lattice the memory has room for: max_memory_gib, or what is free. Throws InvalidInput
/// when there is not enough for the image and the coarsest lattice.
std::size_t tets_that_fit(const Options& options, const LabelImage& image, const TissueImage& tissues);

}  // namespace anatomesh
