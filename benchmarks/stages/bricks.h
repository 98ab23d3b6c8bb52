// Segmented images of any size and number of labels, to measure on.
#pragma once

#include <cstddef>

#include "anatomesh/label_image.h"

namespace anatomesh::benchmarks {

/// A ball of tissue in a cube of `side` voxels of 1 mm, divided into wavy bricks: `labels` tissues or a few less, each
/// in one part. The same in every run.
LabelImage wavy_bricks(std::size_t side, std::size_t labels);

/// One tissue: a ball of `radius` voxels in the middle of a cube of `side` voxels of 1 mm.
LabelImage small_ball(std::size_t side, double radius);

}  // namespace anatomesh::benchmarks
