#include "boundary/voxel_weights.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/parallel.h"

namespace anatomesh {
namespace {

constexpr int kReach = 2;  // of the smoothing kernel, voxels
constexpr std::size_t kWidth = 2 * kReach + 1;
// Share of the kernel [1 2 1]/4 and of [1 4 6 4 1]/16 (along each axis); what is missing to 1 is the voxel itself.
// Their variances are 1/2 and 1, so these shares give -1/3, and that of the B-spline is 1/3.
constexpr double kNear = 8.0 / 3, kFar = -5.0 / 3;
constexpr double kLeast = 0.1, kMost = 1.5;

// The margin at its own centre that a thin structure gets: that of a sheet one voxel thick.
constexpr double kThinMargin = 1.0 / 3;
constexpr double kMostThin = 3;
constexpr int kTogether = 3;
constexpr int kThinRounds = 4;

struct Voxel {
  int i, j, k;
};

// The weights of a few tissues.
class Tally {
 public:
  void add(TissueId tissue, double weight) {
    std::size_t n = 0;
    while (n < count_ && tissues_[n] != tissue) ++n;
    if (n == count_) {
      tissues_[n] = tissue;
      sums_[n] = 0;
      ++count_;
    }
    sums_[n] += weight;
  }
  // Weight of a tissue less that of the heaviest other.
  double margin(TissueId own) const {
    double mine = 0, other = 0;
    for (std::size_t n = 0; n < count_; ++n) {
      if (tissues_[n] == own) {
        mine = sums_[n];
      } else {
        other = std::max(other, sums_[n]);
      }
    }
    return mine - other;
  }

 private:
  std::size_t count_ = 0;
  std::array<TissueId, kWidth * kWidth * kWidth> tissues_;
  std::array<double, kWidth * kWidth * kWidth> sums_;
};

std::array<double, kWidth * kWidth * kWidth> smoothing_kernel() {
  constexpr std::array<double, kWidth> kNearRow = {0, 1 / 4., 2 / 4., 1 / 4., 0};
  constexpr std::array<double, kWidth> kFarRow = {1 / 16., 4 / 16., 6 / 16., 4 / 16., 1 / 16.};
  std::array<double, kWidth * kWidth * kWidth> kernel;
  for (std::size_t n = 0; n < kernel.size(); ++n) {
    const std::size_t i = n % kWidth, j = n / kWidth % kWidth, k = n / kWidth / kWidth;
    kernel[n] = kNear * kNearRow[i] * kNearRow[j] * kNearRow[k] + kFar * kFarRow[i] * kFarRow[j] * kFarRow[k];
  }
  kernel[kernel.size() / 2] += 1 - kNear - kFar;
  return kernel;
}

class Weighing {
 public:
  explicit Weighing(const TissueImage& image)
      : image_(image), weights_(image.voxels.size(), static_cast<std::uint8_t>(kWeightUnit)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int n = -kReach; n < image.size[axis] + kReach; ++n)
        read_at_[axis].push_back(voxel_read_at(n, image.inside(axis), image.size[axis]));
    }
  }

  void smooth() {
    const auto rows = static_cast<std::size_t>(image_.size[1]) * static_cast<std::size_t>(image_.size[2]);
    parallel_blocks(rows, 64, [&](std::size_t begin, std::size_t end) {
      std::vector<TissueId> differs(static_cast<std::size_t>(image_.size[0]));
      for (std::size_t row = begin; row < end; ++row) {
        const auto ny = static_cast<std::size_t>(image_.size[1]);
        smooth_row(static_cast<int>(row % ny), static_cast<int>(row / ny), differs);
      }
    });
  }

  void keep_thin_structures() {
    const std::vector<Voxel> thin = thin_voxels();
    std::vector<std::uint8_t> next(thin.size());
    for (int round = 0; round < kThinRounds; ++round) {
      parallel_for(thin.size(), [&](std::size_t n) { next[n] = raised(thin[n]); });
      for (std::size_t n = 0; n < thin.size(); ++n) weights_[image_.offset(thin[n].i, thin[n].j, thin[n].k)] = next[n];
    }
  }

  std::vector<std::uint8_t> take() { return std::move(weights_); }

 private:
  std::size_t read_offset(int i, int j, int k) const {
    const auto at = [&](std::size_t axis, int n) { return read_at_[axis][static_cast<std::size_t>(n + kReach)]; };
    return image_.offset(at(0, i), at(1, j), at(2, k));
  }

  void smooth_row(int j, int k, std::vector<TissueId>& differs) {
    const TissueId* own = &image_.voxels[image_.offset(0, j, k)];
    const std::size_t nx = differs.size();
    std::fill(differs.begin(), differs.end(), TissueId{0});
    for (int c = k - kReach; c <= k + kReach; ++c) {
      for (int b = j - kReach; b <= j + kReach; ++b) {
        const TissueId* other = &image_.voxels[read_offset(0, b, c)];
        const TissueId* row = other - read_at_[0][kReach];
        for (std::size_t i = 0; i < nx; ++i) differs[i] = static_cast<TissueId>(differs[i] | (row[i] ^ own[i]));
      }
    }
    for (std::size_t i = 1; i < nx; ++i) differs[i] = static_cast<TissueId>(differs[i] | (own[i] ^ own[i - 1]));
    for (int i = 0; i < image_.size[0]; ++i) {
      const int last = std::min(i + kReach, image_.size[0] - 1);
      bool mixed = false;
      for (int a = std::max(i - kReach, 0); a <= last; ++a) mixed |= differs[static_cast<std::size_t>(a)] != 0;
      if (mixed) weights_[image_.offset(i, j, k)] = smoothed(i, j, k);
    }
  }

  std::uint8_t smoothed(int i, int j, int k) const {
    static const auto kernel = smoothing_kernel();
    Tally tally;
    const double* weight = kernel.data();
    for (int c = k - kReach; c <= k + kReach; ++c) {
      for (int b = j - kReach; b <= j + kReach; ++b) {
        for (int a = i - kReach; a <= i + kReach; ++a) tally.add(image_.voxels[read_offset(a, b, c)], *weight++);
      }
    }
    return stored(std::clamp(tally.margin(image_.at(i, j, k)), kLeast, kMost));
  }

  static std::uint8_t stored(double weight) { return static_cast<std::uint8_t>(weight * kWeightUnit + 0.5); }

  // By how much the voxel's tissue wins at its centre in the field.
  double margin_at_centre(Voxel v) const {
    constexpr std::array<double, 3> kSpline = {1 / 6., 4 / 6., 1 / 6.};
    Tally tally;
    for (int n = 0; n < 27; ++n) {
      const int a = n % 3, b = n / 3 % 3, c = n / 9;
      const std::size_t at = read_offset(v.i + a - 1, v.j + b - 1, v.k + c - 1);
      const double spline = kSpline[static_cast<std::size_t>(a)] * kSpline[static_cast<std::size_t>(b)] *
                            kSpline[static_cast<std::size_t>(c)];
      tally.add(image_.voxels[at], spline * weights_[at] / kWeightUnit);
    }
    return tally.margin(image_.at(v.i, v.j, v.k));
  }

  std::vector<Voxel> lost_voxels() const {
    std::vector<std::vector<Voxel>> slices(static_cast<std::size_t>(image_.size[2]));
    parallel_for(
        slices.size(),
        [&](std::size_t slice) {
          const int k = static_cast<int>(slice);
          for (int j = 0; j < image_.size[1]; ++j) {
            for (int i = 0; i < image_.size[0]; ++i) {
              if (weights_[image_.offset(i, j, k)] < kWeightUnit && margin_at_centre({i, j, k}) < 0)
                slices[slice].push_back({i, j, k});
            }
          }
        },
        1);
    std::vector<Voxel> lost;
    for (const auto& slice : slices) lost.insert(lost.end(), slice.begin(), slice.end());
    return lost;
  }

  std::vector<Voxel> thin_voxels() const {
    const std::vector<Voxel> lost = lost_voxels();
    std::vector<bool> is_lost(image_.voxels.size());
    for (const Voxel& v : lost) is_lost[image_.offset(v.i, v.j, v.k)] = true;
    std::vector<Voxel> thin;
    for (const Voxel& v : lost) {
      int together = 0;
      for (int n = 0; n < 27; ++n) {
        const std::size_t at = read_offset(v.i + n % 3 - 1, v.j + n / 3 % 3 - 1, v.k + n / 9 - 1);
        together += is_lost[at] && image_.voxels[at] == image_.at(v.i, v.j, v.k);
      }
      if (together >= kTogether) thin.push_back(v);
    }
    return thin;
  }

  std::uint8_t raised(Voxel v) const {
    constexpr double kShare = 4 / 9.;  // of a voxel of a straight line and its neighbours there at the voxel's centre
    const double weight = weights_[image_.offset(v.i, v.j, v.k)] / static_cast<double>(kWeightUnit);
    return stored(std::min(weight + std::max(0.0, kThinMargin - margin_at_centre(v)) / kShare, kMostThin));
  }

  const TissueImage& image_;
  std::array<std::vector<int>, 3> read_at_;  // voxel_read_at() from -kReach on
  std::vector<std::uint8_t> weights_;
};

}  // namespace

int voxel_read_at(int index, std::pair<int, int> inside, int size) {
  const auto [first, end] = inside;
  const int mirrored = index < first ? 2 * first - 1 - index : index >= end ? 2 * end - 1 - index : index;
  return std::clamp(mirrored, 0, size - 1);
}

std::vector<std::uint8_t> voxel_weights(const TissueImage& image) {
  Weighing weighing(image);
  weighing.smooth();
  weighing.keep_thin_structures();
  return weighing.take();
}

}  // namespace anatomesh
