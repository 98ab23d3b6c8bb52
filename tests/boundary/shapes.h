// Label images of shapes whose true surface is known.
#pragma once

#include <functional>

#include "image/tissue_image.h"
#include "support/test_images.h"

namespace anatomesh::testing {

/// An image of size^3 voxels whose labels are those of their centres (mm, frame index * spacing).
inline TissueImage tissues_of(int size, Vec3 spacing_mm, const std::function<Label(Vec3)>& label_at_mm) {
  const std::size_t n = static_cast<std::size_t>(size);
  LabelImage image = make_image({n, n, n}, [&](int i, int j, int k) {
    return label_at_mm({i * spacing_mm.x, j * spacing_mm.y, k * spacing_mm.z});
  });
  image.spacing_mm = spacing_mm;
  return make_tissue_image(image);
}

}  // namespace anatomesh::testing
