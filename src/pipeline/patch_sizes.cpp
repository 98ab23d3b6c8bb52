#include "pipeline/patch_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace anatomesh {
namespace {

constexpr double kGrowth = 0.7;  // of the size, mm a mm

// Two sweeps over the voxels, forth and back, with the 26 neighbours of each: distances are right to some percent.
void spread(const TissueImage& image, std::vector<float>& size) {
  struct Step {
    std::array<int, 3> to;
    float length;
  };
  std::vector<Step> steps;
  for (int n = 0; n < 13; ++n) {
    const std::array<int, 3> to = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a) square += std::pow(to[a] * image.spacing_mm[a], 2);
    steps.push_back({to, static_cast<float>(kGrowth * std::sqrt(square))});
  }
  const auto [nx, ny, nz] = image.size;
  for (const int sign : {1, -1}) {
    const auto visit = [&](int i, int j, int k) {
      float& own = size[image.offset(i, j, k)];
      for (const Step& step : steps) {
        const int a = i + sign * step.to[0], b = j + sign * step.to[1], c = k + sign * step.to[2];
        if (image.contains(a, b, c)) own = std::min(own, size[image.offset(a, b, c)] + step.length);
      }
    };
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          if (sign > 0) {
            visit(i, j, k);
          } else {
            visit(nx - 1 - i, ny - 1 - j, nz - 1 - k);
          }
        }
      }
    }
  }
}

}  // namespace

PatchSizes::PatchSizes(const TissueImage& image, std::span<const double> surface_mm,
                       const std::vector<char>& is_changed, std::span<const FinePlace> fine)
    : image_(image), size_mm_(image.voxels.size(), std::numeric_limits<float>::max()) {
  const auto size_of = [&](TissueId t) { return t == 0 ? std::numeric_limits<double>::infinity() : surface_mm[t]; };
  const auto meet = [&](std::size_t v, std::size_t w) {
    if (image.voxels[v] == image.voxels[w] || !(is_changed[v] || is_changed[w])) return;
    const auto size = static_cast<float>(std::min(size_of(image.voxels[v]), size_of(image.voxels[w])));
    size_mm_[v] = std::min(size_mm_[v], size);
    size_mm_[w] = std::min(size_mm_[w], size);
  };
  const auto nx = static_cast<std::size_t>(image.size[0]), slice = nx * static_cast<std::size_t>(image.size[1]);
  for (int k = 0; k < image.size[2]; ++k) {
    for (int j = 0; j < image.size[1]; ++j) {
      for (int i = 0; i < image.size[0]; ++i) {
        const std::size_t v = image.offset(i, j, k);
        if (i > 0) meet(v - 1, v);
        if (j > 0) meet(v - nx, v);
        if (k > 0) meet(v - slice, v);
      }
    }
  }
  for (const FinePlace& place : fine) {
    const auto [i, j, k] = image.index_at(place.at_mm);
    if (!image.contains(i, j, k)) continue;
    float& size = size_mm_[image.offset(i, j, k)];
    size = std::min(size, static_cast<float>(place.size_mm));
  }
  spread(image, size_mm_);
}

double PatchSizes::at(Vec3 p_mm) const {
  std::array<int, 3> at = image_.index_at(p_mm);
  for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0, image_.size[a] - 1);
  return static_cast<double>(size_mm_[image_.offset(at[0], at[1], at[2])]);
}

}  // namespace anatomesh
