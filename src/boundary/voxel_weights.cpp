#include "boundary/voxel_weights.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/parallel.h"
#include "base/vector_clones.h"

namespace anatomesh {
namespace {

constexpr int kReach = 2;  // of the smoothing kernel, voxels
constexpr std::size_t kWidth = 2 * kReach + 1;
constexpr std::size_t kVoxels = kWidth * kWidth * kWidth;
// The kernel is 8/3 of [1 2 1]/4 less 5/3 of [1 4 6 4 1]/16 (along each axis). Their variances are 1/2 and 1, so these
// shares give -1/3, and that of the B-spline is 1/3. In units of 1/kKernelUnit all its values are integers, whose sums
// stay within 16 bits.
constexpr int kNear = 8 * 64, kFar = -5, kKernelUnit = 3 * 16 * 16 * 16;
constexpr double kLeast = 0.1, kMost = 1.5;

// The margin at its own centre that a thin structure gets: that of a sheet one voxel thick.
constexpr double kThinMargin = 1.0 / 3;
constexpr double kMostThin = 3;
constexpr int kTogether = 3;
constexpr int kThinRounds = 4;
// Smoothing, the voxels lost by it, those together, and from each round to the next.
static_assert(kReach + 1 + 1 + kThinRounds <= kWeightReach);

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
  std::array<TissueId, kVoxels> tissues_;
  std::array<double, kVoxels> sums_;
};

constexpr std::array<std::int16_t, kVoxels> smoothing_kernel() {
  constexpr std::array<int, kWidth> kNearRow = {0, 1, 2, 1, 0}, kFarRow = {1, 4, 6, 4, 1};
  std::array<std::int16_t, kVoxels> kernel{};
  for (std::size_t n = 0; n < kVoxels; ++n) {
    const std::size_t i = n % kWidth, j = n / kWidth % kWidth, k = n / kWidth / kWidth;
    kernel[n] = static_cast<std::int16_t>(kNear * kNearRow[i] * kNearRow[j] * kNearRow[k] +
                                          kFar * kFarRow[i] * kFarRow[j] * kFarRow[k]);
  }
  return kernel;
}

constexpr std::array<std::int16_t, kVoxels> kKernel = smoothing_kernel();

// Sum of the kernel over the voxels of one tissue, and whether all voxels are of that one or the other.
struct OwnShare {
  std::int16_t sum;
  bool only_two;
};

ANATOMESH_VECTOR_CLONES OwnShare share_of(const TissueId* __restrict tissues, TissueId own, TissueId other) {
  std::uint16_t sum = 0, known = 0xffff;
  for (std::size_t n = 0; n < kVoxels; ++n) {
    const auto is_own = static_cast<std::uint16_t>(tissues[n] == own ? 0xffff : 0);
    const auto is_other = static_cast<std::uint16_t>(tissues[n] == other ? 0xffff : 0);
    sum = static_cast<std::uint16_t>(sum + (is_own & static_cast<std::uint16_t>(kKernel[n])));
    known = static_cast<std::uint16_t>(known & (is_own | is_other));
  }
  return {static_cast<std::int16_t>(sum), known != 0};
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
    std::array<TissueId, kVoxels> tissues;
    TissueId* to = tissues.data();
    const int* const columns = &read_at_[0][static_cast<std::size_t>(i)];  // from i - kReach on
    for (int c = k - kReach; c <= k + kReach; ++c) {
      for (int b = j - kReach; b <= j + kReach; ++b) {
        const TissueId* const row = &image_.voxels[read_offset(0, b, c)] - read_at_[0][kReach];
        for (std::size_t a = 0; a < kWidth; ++a) *to++ = row[columns[a]];
      }
    }
    return stored(std::clamp(smoothed_margin(tissues, image_.at(i, j, k)), kLeast, kMost));
  }

  static double smoothed_margin(const std::array<TissueId, kVoxels>& tissues, TissueId own) {
    const auto other = std::ranges::find_if(tissues, [own](TissueId t) { return t != own; });
    const auto [sum, only_two] = share_of(tissues.data(), own, other == tissues.end() ? own : *other);
    if (only_two) return static_cast<double>(sum - std::max(0, kKernelUnit - sum)) / kKernelUnit;
    Tally tally;
    for (std::size_t n = 0; n < kVoxels; ++n) tally.add(tissues[n], kKernel[n]);
    return tally.margin(own) / kKernelUnit;
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
