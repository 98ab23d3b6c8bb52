// How thick each tissue is around each of its voxels.
#pragma once

#include <stop_token>
#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// Distance (mm) of each voxel's centre to the nearest face of its tissue's voxels, `cap_mm` at the most; 0 in the
/// background. Exact, after the separable transform of Felzenszwalb and Huttenlocher 2012 run inside each tissue.
/// Cost: about (cap_mm / spacing) nanoseconds a labelled voxel and axis; 4 bytes a voxel. Throws Cancelled.
std::vector<float> distance_to_tissue_faces(const TissueImage& image, double cap_mm, const std::stop_token& cancel);

/// Diameter (mm) of the largest ball inside its tissue that holds the voxel's centre (Hildebrand and Rüegsegger 1997),
/// infinite above cap_mm and in the background; then the largest within two voxels, so that the steps of a surface of
/// voxels do not count as thin. Cost: as above and a few nanoseconds for each voxel of each
/// ball about a voxel on the tissue's medial axis. Throws Cancelled.
std::vector<float> local_thickness(const TissueImage& image, double cap_mm, const std::stop_token& cancel);

}  // namespace anatomesh
