// An image with its place in space, its voxels still to be filled in.
#pragma once

#include <array>
#include <filesystem>

#include "anatomesh/label_image.h"
#include "io/image_geometry.h"

namespace anatomesh {

/// An image of zeros. value_bytes is the size of a voxel in the file, of which the reader holds a copy; 0 if it
/// holds none. Throws InvalidInput where the geometry is unusable or the memory would not do.
LabelImage blank_image(const std::filesystem::path& path, std::array<std::size_t, 3> size,
                       const ImageGeometry& geometry, std::size_t value_bytes);

}  // namespace anatomesh
