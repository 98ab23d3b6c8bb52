// Where an image lies in space, as files give it and as LabelImage wants it.
#pragma once

#include <filesystem>

#include "anatomesh/label_image.h"

namespace anatomesh {

/// Spacing, origin and direction of an image, in the terms of LabelImage.
struct ImageGeometry {
  Vec3 spacing_mm;
  Vec3 origin_mm;
  Mat3 direction = kIdentity3;
};

/// Physical point of the index (i, j, k), which need not be whole.
Vec3 physical_point(const ImageGeometry& geometry, Vec3 index);

/// Throws InvalidInput naming the file unless spacing and origin are finite, spacing is positive and
/// direction is orthonormal within kDirectionTolerance (base/rotation.h). Returns it with an exactly orthonormal
/// direction.
ImageGeometry checked_geometry(const std::filesystem::path& path, const ImageGeometry& geometry);

}  // namespace anatomesh
