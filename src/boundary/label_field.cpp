// The smoothed label field. The kernel and its derivative are the cubic B-spline of
// M. Unser, "Splines: a perfect fit for signal and image processing", IEEE Signal Processing Magazine 16(6), 1999,
// used as a low-pass filter (the labels' indicator functions are the coefficients; nothing is interpolated).
#include "boundary/label_field.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "boundary/cubic_spline.h"

namespace anatomesh {
namespace {

// Weights nearer than this count as equal: it is above their rounding errors.
constexpr double kTie = 1e-12;

// The voxels of one tissue in a row of four are a subset of {0, 1, 2, 3}: their weight is looked up by its bits.
using SubsetSums = std::array<double, 16>;

SubsetSums subset_sums(const std::array<double, 4>& w) {
  SubsetSums sums{};
  for (std::size_t bit = 0; bit < 4; ++bit) {
    for (std::size_t s = 0; s < (std::size_t{1} << bit); ++s) sums[s | (std::size_t{1} << bit)] = sums[s] + w[bit];
  }
  return sums;
}

// First of the four voxels around a coordinate (in voxels of the crop), and where in the middle interval it lies.
struct Support {
  int first;
  double t;  // 0 to 1
};

Support support_of(double x, int size) {
  // Everything 4 voxels outside the crop and beyond looks the same; this also keeps the cast in range.
  const double lo = -4, hi = static_cast<double>(size) + 4;
  const double clamped = !(x > lo) ? lo : x < hi ? x : hi;
  const int cell = static_cast<int>(clamped + 8) - 8;  // floor, as clamped >= -4
  return {cell - 1, clamped - static_cast<double>(cell)};
}

// The 64 voxels around a point: in the image itself, or copied here where they reach out of the crop.
class Neighbourhood {
 public:
  Neighbourhood(const TissueImage& image, int i, int j, int k) {
    if (i >= 0 && j >= 0 && k >= 0 && i + 4 <= image.size[0] && j + 4 <= image.size[1] && k + 4 <= image.size[2]) {
      voxels_ = &image.voxels[image.offset(i, j, k)];
      row_ = static_cast<std::size_t>(image.size[0]);
      slice_ = row_ * static_cast<std::size_t>(image.size[1]);
      return;
    }
    TissueId* to = copy_.data();
    for (int c = k; c < k + 4; ++c) {
      for (int b = j; b < j + 4; ++b) {
        for (int a = i; a < i + 4; ++a) *to++ = image.at_or_background(a, b, c);
      }
    }
    voxels_ = copy_.data();
    row_ = 4;
    slice_ = 16;
  }
  Neighbourhood(const Neighbourhood&) = delete;
  Neighbourhood& operator=(const Neighbourhood&) = delete;

  const TissueId* row(std::size_t j, std::size_t k) const { return voxels_ + j * row_ + k * slice_; }

 private:
  const TissueId* voxels_;
  std::size_t row_, slice_;
  std::array<TissueId, 64> copy_;
};

std::size_t bits_of(const TissueId* row, TissueId t) {
  return static_cast<std::size_t>(row[0] == t) | static_cast<std::size_t>(row[1] == t) << 1 |
         static_cast<std::size_t>(row[2] == t) << 2 | static_cast<std::size_t>(row[3] == t) << 3;
}

// Weights of the distinct tissues around a point, in ascending order of tissue.
class TissueWeights {
 public:
  void add(TissueId tissue, double weight) {
    std::size_t at = 0;
    while (at < count_ && tissues_[at] < tissue) ++at;
    if (at == count_ || tissues_[at] != tissue) {
      std::copy_backward(&tissues_[at], &tissues_[count_], &tissues_[count_] + 1);
      std::copy_backward(&weights_[at], &weights_[count_], &weights_[count_] + 1);
      tissues_[at] = tissue;
      weights_[at] = 0;
      ++count_;
    }
    weights_[at] += weight;
  }

  TissueId heaviest() const {
    std::size_t best = 0;
    for (std::size_t at = 1; at < count_; ++at) {
      if (weights_[at] > weights_[best] + kTie) best = at;
    }
    return tissues_[best];
  }

 private:
  std::array<TissueId, 65> tissues_;  // one place more than there can be, for the shift
  std::array<double, 65> weights_;
  std::size_t count_ = 0;
};

}  // namespace

LabelField::LabelField(const TissueImage& image)
    : image_(&image),
      voxels_per_mm_{1 / image.spacing_mm.x, 1 / image.spacing_mm.y, 1 / image.spacing_mm.z},
      first_{static_cast<double>(image.first[0]), static_cast<double>(image.first[1]),
             static_cast<double>(image.first[2])} {}

void LabelField::evaluate(Vec3 p, std::span<const TissueId> tissues, std::span<double> values,
                          std::span<Vec3> gradients) const {
  const Support x = support_of(p.x * voxels_per_mm_.x - first_.x, image_->size[0]);
  const Support y = support_of(p.y * voxels_per_mm_.y - first_.y, image_->size[1]);
  const Support z = support_of(p.z * voxels_per_mm_.z - first_.z, image_->size[2]);
  const Neighbourhood around(*image_, x.first, y.first, z.first);
  const SubsetSums wx = subset_sums(spline_weights(x.t)), dx = subset_sums(spline_slopes(x.t));
  const std::array<double, 4> wy = spline_weights(y.t), dy = spline_slopes(y.t);
  const std::array<double, 4> wz = spline_weights(z.t), dz = spline_slopes(z.t);
  for (std::size_t n = 0; n < tissues.size(); ++n) {
    double value = 0;
    Vec3 slope;
    for (std::size_t k = 0; k < 4; ++k) {
      double slice = 0, slice_dx = 0, slice_dy = 0;
      for (std::size_t j = 0; j < 4; ++j) {
        const std::size_t bits = bits_of(around.row(j, k), tissues[n]);
        slice += wy[j] * wx[bits];
        slice_dx += wy[j] * dx[bits];
        slice_dy += dy[j] * wx[bits];
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

TissueId LabelField::label_at(Vec3 p) const {
  const Support x = support_of(p.x * voxels_per_mm_.x - first_.x, image_->size[0]);
  const Support y = support_of(p.y * voxels_per_mm_.y - first_.y, image_->size[1]);
  const Support z = support_of(p.z * voxels_per_mm_.z - first_.z, image_->size[2]);
  const Neighbourhood around(*image_, x.first, y.first, z.first);
  const std::array<double, 4> wx = spline_weights(x.t), wy = spline_weights(y.t), wz = spline_weights(z.t);

  // The tissue of the nearest voxel mostly has more than half of the weight, which settles it.
  const TissueId nearest = around.row(y.t < 0.5 ? 1 : 2, z.t < 0.5 ? 1 : 2)[x.t < 0.5 ? 1 : 2];
  const SubsetSums sums = subset_sums(wx);
  double of_nearest = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) of_nearest += wy[j] * wz[k] * sums[bits_of(around.row(j, k), nearest)];
  }
  if (of_nearest > 0.5 + kTie) return nearest;

  TissueWeights weights;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      const TissueId* row = around.row(j, k);
      for (std::size_t i = 0; i < 4; ++i) weights.add(row[i], wx[i] * wy[j] * wz[k]);
    }
  }
  return weights.heaviest();
}

}  // namespace anatomesh
