#include "boundary/surface_field.h"

#include <algorithm>
#include <cstddef>

#include "base/vec.h"
#include "boundary/cubic_spline.h"
#include "boundary/voxel_weights.h"

namespace anatomesh {
namespace {

// The four voxels around a coordinate (in voxels of the crop), and where in the middle interval it lies.
struct Support {
  std::array<std::size_t, 4> voxel;
  double t;  // 0 to 1

  Support(double x, int size, std::pair<int, int> inside) {
    // Everything 4 voxels outside the crop and beyond looks the same; this also keeps the cast in range.
    const double lo = -4, hi = static_cast<double>(size) + 4;
    const double clamped = !(x > lo) ? lo : x < hi ? x : hi;
    const int cell = static_cast<int>(clamped + 8) - 8;  // floor, as clamped >= -4
    t = clamped - static_cast<double>(cell);
    for (int n = 0; n < 4; ++n)
      voxel[static_cast<std::size_t>(n)] = static_cast<std::size_t>(voxel_read_at(cell - 1 + n, inside, size));
  }
};

}  // namespace

SurfaceField::SurfaceField(const TissueImage& image)
    : image_(&image),
      voxels_per_mm_{1 / image.spacing_mm.x, 1 / image.spacing_mm.y, 1 / image.spacing_mm.z},
      first_{static_cast<double>(image.first[0]), static_cast<double>(image.first[1]),
             static_cast<double>(image.first[2])},
      weights_(voxel_weights(image)) {}

void SurfaceField::evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values,
                            std::span<Vec3> gradients) const {
  const Support x(p.x * voxels_per_mm_.x - first_.x, image_->size[0], image_->inside(0));
  const Support y(p.y * voxels_per_mm_.y - first_.y, image_->size[1], image_->inside(1));
  const Support z(p.z * voxels_per_mm_.z - first_.z, image_->size[2], image_->inside(2));
  std::array<TissueId, 64> tissue;
  std::array<double, 64> weight;
  const auto nx = static_cast<std::size_t>(image_->size[0]), ny = static_cast<std::size_t>(image_->size[1]);
  for (std::size_t k = 0, to = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const std::size_t row = nx * (y.voxel[j] + ny * z.voxel[k]);
      for (std::size_t i = 0; i < 4; ++i, ++to) {
        tissue[to] = image_->voxels[row + x.voxel[i]];
        weight[to] = weights_[row + x.voxel[i]];
      }
    }
  }
  const std::array<double, 4> wx = spline_weights(x.t), dx = spline_slopes(x.t);
  const std::array<double, 4> wy = spline_weights(y.t), dy = spline_slopes(y.t);
  const std::array<double, 4> wz = spline_weights(z.t), dz = spline_slopes(z.t);
  for (std::size_t n = 0; n < tissues.size(); ++n) {
    double value = 0;
    Vec3 slope;
    for (std::size_t k = 0; k < 4; ++k) {
      double slice = 0, slice_dx = 0, slice_dy = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        double sum = 0, sum_dx = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          const std::size_t at = i + 4 * (j + 4 * k);
          const double m = tissue[at] == tissues[n] ? weight[at] : 0.0;
          sum += wx[i] * m;
          sum_dx += dx[i] * m;
        }
        slice += wy[j] * sum;
        slice_dx += wy[j] * sum_dx;
        slice_dy += dy[j] * sum;
      }
      value += wz[k] * slice;
      slope.x += wz[k] * slice_dx;
      slope.y += wz[k] * slice_dy;
      slope.z += dz[k] * slice;
    }
    constexpr double kScale = 1.0 / kWeightUnit;
    values[n] = kScale * value;
    gradients[n] = kScale * Vec3{slope.x * voxels_per_mm_.x, slope.y * voxels_per_mm_.y, slope.z * voxels_per_mm_.z};
  }
}

}  // namespace anatomesh
