#include "boundary/surface_field.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/vec.h"
#include "base/vector_clones.h"
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

// By lanes, each with its own sum; then the lanes are added up in a tree.
ANATOMESH_VECTOR_CLONES void sum_rows(const std::int16_t* __restrict share, const double* __restrict wx,
                                      const double* __restrict dx, const double* __restrict wy_wz,
                                      const double* __restrict dy_wz, const double* __restrict wy_dz,
                                      double* __restrict sums) {
  double value[16], slope_x[16], slope_y[16], slope_z[16];
  for (std::size_t r = 0; r < 16; ++r) {
    const double s0 = share[r], s1 = share[16 + r], s2 = share[32 + r], s3 = share[48 + r];
    const double sum = (wx[0] * s0 + wx[1] * s1) + (wx[2] * s2 + wx[3] * s3);
    value[r] = sum * wy_wz[r];
    slope_x[r] = ((dx[0] * s0 + dx[1] * s1) + (dx[2] * s2 + dx[3] * s3)) * wy_wz[r];
    slope_y[r] = sum * dy_wz[r];
    slope_z[r] = sum * wy_dz[r];
  }
  for (std::size_t half = 8; half > 0; half /= 2) {
    for (std::size_t r = 0; r < half; ++r) {
      value[r] += value[r + half];
      slope_x[r] += slope_x[r + half];
      slope_y[r] += slope_y[r + half];
      slope_z[r] += slope_z[r + half];
    }
  }
  sums[0] = value[0];
  sums[1] = slope_x[0];
  sums[2] = slope_y[0];
  sums[3] = slope_z[0];
}

}  // namespace

// The 64 voxels around a point: those of one place along x follow each other, in rows of z and y.
struct SurfaceField::Near {
  std::array<TissueId, 64> tissue;
  std::array<std::int16_t, 64> weight;
  std::array<double, 4> wx, dx;
  std::array<double, 16> wy_wz, dy_wz, wy_dz;
};

SurfaceField::Sums SurfaceField::sum_up(const Near& near, const std::array<std::int16_t, 64>& share) {
  Sums sums;
  sum_rows(share.data(), near.wx.data(), near.dx.data(), near.wy_wz.data(), near.dy_wz.data(), near.wy_dz.data(),
           sums.data());
  return sums;
}

SurfaceField::SurfaceField(const TissueImage& image) : SurfaceField(image, voxel_weights(image)) {}

SurfaceField::SurfaceField(const TissueImage& image, std::vector<std::uint8_t> weights)
    : image_(&image),
      voxels_per_mm_{1 / image.spacing_mm.x, 1 / image.spacing_mm.y, 1 / image.spacing_mm.z},
      first_{static_cast<double>(image.first[0]), static_cast<double>(image.first[1]),
             static_cast<double>(image.first[2])},
      weights_(std::move(weights)) {}

SurfaceField::Near SurfaceField::voxels_near(Vec3 p) const {
  const Support x(p.x * voxels_per_mm_.x - first_.x, image_->size[0], image_->inside(0));
  const Support y(p.y * voxels_per_mm_.y - first_.y, image_->size[1], image_->inside(1));
  const Support z(p.z * voxels_per_mm_.z - first_.z, image_->size[2], image_->inside(2));
  Near near;
  const auto nx = static_cast<std::size_t>(image_->size[0]), ny = static_cast<std::size_t>(image_->size[1]);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const std::size_t row = nx * (y.voxel[j] + ny * z.voxel[k]);
      for (std::size_t i = 0; i < 4; ++i) {
        near.tissue[16 * i + 4 * k + j] = image_->voxels[row + x.voxel[i]];
        near.weight[16 * i + 4 * k + j] = weights_[row + x.voxel[i]];
      }
    }
  }
  constexpr double kScale = 1.0 / kWeightUnit;
  const std::array<double, 4> wy = spline_weights(y.t), dy = spline_slopes(y.t);
  const std::array<double, 4> wz = spline_weights(z.t), dz = spline_slopes(z.t);
  near.wx = spline_weights(x.t);
  near.dx = spline_slopes(x.t);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      near.wy_wz[4 * k + j] = kScale * wy[j] * wz[k];
      near.dy_wz[4 * k + j] = kScale * dy[j] * wz[k];
      near.wy_dz[4 * k + j] = kScale * wy[j] * dz[k];
    }
  }
  return near;
}

SurfaceField::Value SurfaceField::scaled(const Sums& sums) const {
  return {sums[0], {sums[1] * voxels_per_mm_.x, sums[2] * voxels_per_mm_.y, sums[3] * voxels_per_mm_.z}};
}

void SurfaceField::evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values,
                            std::span<Vec3> gradients) const {
  const Near near = voxels_near(p);
  for (std::size_t n = 0; n < tissues.size(); ++n) {
    std::array<std::int16_t, 64> share;
    for (std::size_t v = 0; v < 64; ++v) share[v] = near.tissue[v] == tissues[n] ? near.weight[v] : std::int16_t{0};
    const Value value = scaled(sum_up(near, share));
    values[n] = value.value;
    gradients[n] = value.gradient;
  }
}

SurfaceField::Value SurfaceField::difference(Vec3 p, TissueId a, TissueId b) const {
  const Near near = voxels_near(p);
  std::array<std::int16_t, 64> share;
  for (std::size_t v = 0; v < 64; ++v) {
    const std::int16_t of_b = near.tissue[v] == b ? near.weight[v] : std::int16_t{0};
    share[v] = near.tissue[v] == a ? static_cast<std::int16_t>(-near.weight[v]) : of_b;
  }
  return scaled(sum_up(near, share));
}

}  // namespace anatomesh
