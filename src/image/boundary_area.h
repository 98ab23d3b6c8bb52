// How much boundary a tissue has.
#pragma once

#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// Area of the voxel faces between each tissue and all others, mm^2, by tissue; [0] is the background's. An interface
/// counts for both of its tissues. A smooth surface has about two thirds of the area of its stairs.
std::vector<double> boundary_areas_mm2(const TissueImage& image);

}  // namespace anatomesh
