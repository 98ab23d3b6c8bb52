#include "pipeline/patch_weights.h"

#include <algorithm>
#include <cstddef>

#include "base/parallel.h"
#include "boundary/voxel_weights.h"

namespace anatomesh {
namespace {

// Copies the voxels that two crops of one image, or the boxes [low, high) of it, have in common.
void copy_common(const TissueImage& from, const std::vector<std::uint8_t>& values, const TissueImage& to,
                 std::vector<std::uint8_t>& result, IndexBox box) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = std::max({box.low[a], from.first[a], to.first[a]});
    box.high[a] = std::min({box.high[a], from.first[a] + from.size[a], to.first[a] + to.size[a]});
    if (box.high[a] <= box.low[a]) return;
  }
  const auto offset = [&](const TissueImage& image, std::int64_t j, std::int64_t k) {
    return static_cast<std::ptrdiff_t>(image.offset(static_cast<int>(box.low[0] - image.first[0]),
                                                    static_cast<int>(j - image.first[1]),
                                                    static_cast<int>(k - image.first[2])));
  };
  for (std::int64_t k = box.low[2]; k < box.high[2]; ++k) {
    for (std::int64_t j = box.low[1]; j < box.high[1]; ++j)
      std::copy_n(values.begin() + offset(from, j, k), box.high[0] - box.low[0], result.begin() + offset(to, j, k));
  }
}

IndexBox grown(IndexBox box, int voxels) {
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] -= voxels;
    box.high[a] += voxels;
  }
  return box;
}

}  // namespace

std::vector<std::uint8_t> updated_weights(const TissueImage& before, const std::vector<std::uint8_t>& weights,
                                          const TissueImage& after, const IndexBox& changed) {
  std::vector<std::uint8_t> result = part_of(before, weights, after.first, after.size);
  const IndexBox inner = grown(changed, kWeightReach), outer = grown(inner, kWeightReach);
  std::array<int, 3> size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<int>(outer.high[a] - outer.low[a]);
  const TissueImage part = part_of(after, outer.low, size);
  copy_common(part, voxel_weights(part), after, result, inner);
  return result;
}

// Beyond the crop, far from all boundaries, a voxel has a weight of 1.
std::vector<std::uint8_t> part_of(const TissueImage& image, const std::vector<std::uint8_t>& weights,
                                  const std::array<std::int64_t, 3>& first, const std::array<int, 3>& size) {
  TissueImage part;
  part.first = first;
  part.size = size;
  std::vector<std::uint8_t> result(
      static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]),
      static_cast<std::uint8_t>(kWeightUnit));
  copy_common(image, weights, part, result, box_of(part));
  return result;
}

}  // namespace anatomesh
