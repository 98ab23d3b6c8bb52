// The surface field's weights of an image that has changed in a few places.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "image/tissue_image.h"
#include "pipeline/mesh_patch.h"

namespace anatomesh {

/// voxel_weights(after), where those of an image that differs in a box only are known. Cost: that of the weights
/// around the box, and a copy of the rest.
std::vector<std::uint8_t> updated_weights(const TissueImage& before, const std::vector<std::uint8_t>& weights,
                                          const TissueImage& after, const IndexBox& changed);

/// The weights of a box of an image (see part_of() for images).
std::vector<std::uint8_t> part_of(const TissueImage& image, const std::vector<std::uint8_t>& weights,
                                  const std::array<std::int64_t, 3>& first, const std::array<int, 3>& size);

}  // namespace anatomesh
