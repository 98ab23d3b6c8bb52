#include "boundary/surface_field.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstdio>

#include "base/parallel.h"

namespace anatomesh {
namespace {

constexpr double kUnit = 64;  // a weight of 1 as stored

double env(const char* name, double other) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : other;
}

std::array<double, 4> spline_weights(double t) {
  const double s = 1 - t;
  return {s * s * s / 6, (4 - 3 * t * t * (2 - t)) / 6, (4 - 3 * s * s * (2 - s)) / 6, t * t * t / 6};
}

std::array<double, 4> spline_slopes(double t) {
  const double s = 1 - t;
  return {-0.5 * s * s, 0.5 * t * (3 * t - 4), -0.5 * s * (3 * s - 4), 0.5 * t * t};
}

struct Support {
  int first;
  double t;
};

Support support_of(double x, int size) {
  const double lo = -4, hi = static_cast<double>(size) + 4;
  const double clamped = !(x > lo) ? lo : x < hi ? x : hi;
  const int cell = static_cast<int>(clamped + 8) - 8;
  return {cell - 1, clamped - static_cast<double>(cell)};
}

struct Tally {
  std::array<TissueId, 126> tissue;
  std::array<double, 126> sum;
  std::size_t n = 0;
  void add(TissueId t, double w) {
    std::size_t i = 0;
    while (i < n && tissue[i] != t) ++i;
    if (i == n) tissue[n] = t, sum[n] = 0, ++n;
    sum[i] += w;
  }
  double margin(TissueId own) const {
    double mine = 0, other = 0;
    bool first = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (tissue[i] == own) mine = sum[i];
      else if (first || sum[i] > other) other = sum[i], first = false;
    }
    return mine - other;
  }
};

}  // namespace

double SurfaceField::weight(int i, int j, int k) const {
  return image_->contains(i, j, k) ? weights_[image_->offset(i, j, k)] / kUnit : 1.0;
}

SurfaceField::SurfaceField(const TissueImage& image)
    : image_(&image),
      voxels_per_mm_{1 / image.spacing_mm.x, 1 / image.spacing_mm.y, 1 / image.spacing_mm.z},
      first_{static_cast<double>(image.first[0]), static_cast<double>(image.first[1]),
             static_cast<double>(image.first[2])},
      weights_(image.voxels.size(), static_cast<std::uint8_t>(kUnit)) {
  const double b = env("SB", 0), c = env("SC", 0), floor = env("SFLOOR", 0.1), thin_target = env("STHIN", 0.33), on=env("SON",1);
  if (on == 0) return;
  const std::array<double, 5> g1 = {0, 0.25, 0.5, 0.25, 0}, g2 = {1 / 16., 4 / 16., 6 / 16., 4 / 16., 1 / 16.},
                              g0 = {0, 0, 1, 0, 0};
  std::array<double, 125> kernel;
  for (std::size_t n = 0; n < 125; ++n) {
    const std::size_t x = n % 5, y = n / 5 % 5, z = n / 25;
    kernel[n] = (1 - b - c) * g0[x] * g0[y] * g0[z] + b * g1[x] * g1[y] * g1[z] + c * g2[x] * g2[y] * g2[z];
  }
  const auto nk = static_cast<std::size_t>(image.size[2]);
  std::vector<std::vector<std::array<int, 3>>> lost(nk);
  parallel_for(
      nk,
      [&](std::size_t kk) {
        const int k = static_cast<int>(kk);
        for (int j = 0; j < image.size[1]; ++j)
          for (int i = 0; i < image.size[0]; ++i) {
            const TissueId own = image.at(i, j, k);
            Tally tally;
            for (std::size_t n = 0; n < 125; ++n)
              tally.add(image.at_or_background(i + static_cast<int>(n % 5) - 2, j + static_cast<int>(n / 5 % 5) - 2,
                                               k + static_cast<int>(n / 25) - 2),
                        kernel[n]);
            if (tally.n == 1) continue;
            weights_[image.offset(i, j, k)] =
                static_cast<std::uint8_t>(kUnit * std::clamp(tally.margin(own), floor, 1.5) + 0.5);
          }
      },
      1);
  if (thin_target <= 0) return;
  // centre margins
  constexpr std::array<double, 3> w = {1 / 6., 4 / 6., 1 / 6.};
  const auto margin = [&](int i, int j, int k) {
    Tally tally;
    for (int c2 = -1; c2 < 2; ++c2)
      for (int b2 = -1; b2 < 2; ++b2)
        for (int a = -1; a < 2; ++a)
          tally.add(image.at_or_background(i + a, j + b2, k + c2),
                    w[static_cast<std::size_t>(a + 1)] * w[static_cast<std::size_t>(b2 + 1)] *
                        w[static_cast<std::size_t>(c2 + 1)] * weight(i + a, j + b2, k + c2));
    return tally.margin(image.at(i, j, k));
  };
  const double lost_below = env("SLOST", 0.0);
  parallel_for(
      nk,
      [&](std::size_t kk) {
        const int k = static_cast<int>(kk);
        for (int j = 0; j < image.size[1]; ++j)
          for (int i = 0; i < image.size[0]; ++i)
            if (weights_[image.offset(i, j, k)] < 64 && margin(i, j, k) < lost_below) lost[kk].push_back({i, j, k});
      },
      1);
  std::vector<char> is_lost(image.voxels.size());
  for (const auto& slice : lost)
    for (const auto& [i, j, k] : slice) is_lost[image.offset(i, j, k)] = 1;
  const int needed = static_cast<int>(env("SNEED", 3));
  std::vector<std::array<int, 3>> thin;
  for (const auto& slice : lost)
    for (const auto& [i, j, k] : slice) {
      int count = 0;
      for (int c2 = -1; c2 < 2; ++c2)
        for (int b2 = -1; b2 < 2; ++b2)
          for (int a = -1; a < 2; ++a)
            count += image.contains(i + a, j + b2, k + c2) && is_lost[image.offset(i + a, j + b2, k + c2)] &&
                     image.at(i + a, j + b2, k + c2) == image.at(i, j, k);
      if (count >= needed) thin.push_back({i, j, k});
    }
  if (std::getenv("SVERB")) printf("lost thin %zu\n", thin.size());
  std::vector<std::uint8_t> next(thin.size());
  for (int round = 0; round < 4; ++round) {
    parallel_for(thin.size(), [&](std::size_t n) {
      const auto& [i, j, k] = thin[n];
      const double want = weight(i, j, k) + std::max(0.0, thin_target - margin(i, j, k)) / 0.45;
      next[n] = static_cast<std::uint8_t>(kUnit * std::min(want, 3.0) + 0.5);
    });
    for (std::size_t n = 0; n < thin.size(); ++n) weights_[image.offset(thin[n][0], thin[n][1], thin[n][2])] = next[n];
  }
}

void SurfaceField::evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values,
                            std::span<Vec3> gradients) const {
  const Support x = support_of(p.x * voxels_per_mm_.x - first_.x, image_->size[0]);
  const Support y = support_of(p.y * voxels_per_mm_.y - first_.y, image_->size[1]);
  const Support z = support_of(p.z * voxels_per_mm_.z - first_.z, image_->size[2]);
  std::array<TissueId, 64> label;
  std::array<double, 64> w;
  std::size_t to = 0;
  for (int c = z.first; c < z.first + 4; ++c)
    for (int b = y.first; b < y.first + 4; ++b)
      for (int a = x.first; a < x.first + 4; ++a, ++to) {
        label[to] = image_->at_or_background(a, b, c);
        w[to] = weight(a, b, c);
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
          const double m = label[at] == tissues[n] ? w[at] : 0.0;
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
    values[n] = value;
    gradients[n] = {slope.x * voxels_per_mm_.x, slope.y * voxels_per_mm_.y, slope.z * voxels_per_mm_.z};
  }
}

}  // namespace anatomesh
