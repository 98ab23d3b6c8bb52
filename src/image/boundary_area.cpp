#include "image/boundary_area.h"

#include <array>
#include <cstddef>
#include <mutex>

#include "base/parallel.h"

namespace anatomesh {

// The crop's last rows and slices are background.
std::vector<double> boundary_areas_mm2(const TissueImage& image) {
  const Vec3 s = image.spacing_mm;
  const auto sx = static_cast<std::size_t>(image.size[0]), sy = static_cast<std::size_t>(image.size[1]);
  const std::array<std::size_t, 3> step = {1, sx, sx * sy};
  const std::array<double, 3> face_mm2 = {s.y * s.z, s.x * s.z, s.x * s.y};
  const std::size_t slices = static_cast<std::size_t>(image.size[2]) - 1;
  std::vector<std::array<std::size_t, 3>> faces(image.labels.size());
  std::mutex adding;
  parallel_for(slices, [&](std::size_t z) {
    std::vector<std::array<std::size_t, 3>> here(image.labels.size());
    for (std::size_t v = z * step[2]; v < (z + 1) * step[2]; ++v) {
      for (std::size_t a = 0; a < 3; ++a) {
        const TissueId one = image.voxels[v], other = image.voxels[v + step[a]];
        if (one == other) continue;
        ++here[one][a];
        ++here[other][a];
      }
    }
    const std::lock_guard lock(adding);
    for (std::size_t t = 0; t < here.size(); ++t) {
      for (std::size_t a = 0; a < 3; ++a) faces[t][a] += here[t][a];
    }
  });
  std::vector<double> areas(faces.size(), 0);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    for (std::size_t a = 0; a < 3; ++a) areas[t] += static_cast<double>(faces[t][a]) * face_mm2[a];
  }
  return areas;
}

}  // namespace anatomesh
