// The weights with which voxels speak for their tissue in the surface field.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "image/tissue_image.h"

namespace anatomesh {

/// Where an index along an axis of the crop reads its voxel: mirrored at the border of the original image (a tissue
/// goes on there as if nothing ended), and held at the border of the crop, where all is background.
int voxel_read_at(int index, std::pair<int, int> inside, int size);

/// A weight for each voxel of the crop in units of 1/kWeightUnit, 1 away from all boundaries.
///
/// Near one it is the margin by which the voxel's tissue wins there in the image smoothed by a kernel of 5 x 5 x 5
/// voxels whose second moment cancels that of a cubic B-spline: a staircase becomes a slope. A curved boundary still
/// moves a little: a ball with the volume of radius 5.089 voxels gets 5.012, and 5.026 with weights of 1 everywhere;
/// settling wins such volumes back. Voxels that lose there keep a little weight. Where a thin structure would lose its
/// own voxels' centres (at least three of them together; a single one is noise), its weights are raised until it keeps
/// them. Cost: about 2 ns a voxel and 0.4 us for each voxel near a boundary. The same for any number of threads.
std::vector<std::uint8_t> voxel_weights(const TissueImage& image);

/// How far, in voxels along each axis, the labels of an image reach in the weights.
constexpr int kWeightReach = 8;

constexpr int kWeightUnit = 64;

}  // namespace anatomesh
