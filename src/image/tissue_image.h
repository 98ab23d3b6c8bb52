// The label image as the mesher works on it: cropped, in dense 16-bit tissue numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/types.h"

namespace anatomesh {

/// Dense number of a tissue: 0 is background, 1 .. n are the image's labels in ascending order.
using TissueId = std::uint16_t;

/// A label image cropped to its labelled voxels plus a border of background on every side (the border
/// may lie outside the original image, so that a tissue that touches the image's border ends half a
/// voxel past its last voxel centre). All positions are in the image's own axis-aligned frame: the centre of
/// voxel (i, j, k) of this crop is at ((first[0] + i) * spacing.x, ...) millimetres.
struct TissueImage {
  static constexpr int kBorder = 4;  ///< voxels of background on each side

  std::array<int, 3> size = {0, 0, 0};
  std::array<std::int64_t, 3> first = {0, 0, 0};  ///< index in the original image of voxel (0, 0, 0); may be negative
  std::array<std::int64_t, 3> whole = {0, 0, 0};  ///< size of the original image, voxels
  Vec3 spacing_mm = {1, 1, 1};
  std::vector<TissueId> voxels;       ///< i fastest
  std::vector<Label> labels;          ///< labels[t]: value of tissue t; labels[0] == 0
  std::vector<std::uint64_t> counts;  ///< counts[t]: voxels of tissue t (of the background: inside the crop)

  std::size_t tissue_count() const { return labels.size() - 1; }  ///< without the background
  std::size_t offset(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(size[0]) *
               (static_cast<std::size_t>(j) + static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(k));
  }
  TissueId at(int i, int j, int k) const { return voxels[offset(i, j, k)]; }
  bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }
  /// Tissue at (i, j, k), background outside the crop.
  TissueId at_or_background(int i, int j, int k) const { return contains(i, j, k) ? at(i, j, k) : TissueId{0}; }
  /// Voxels [first, second) of the crop along an axis are those inside the original image.
  std::pair<int, int> inside(std::size_t axis) const {
    const std::int64_t n = size[axis];
    return {static_cast<int>(std::clamp<std::int64_t>(-first[axis], 0, n)),
            static_cast<int>(std::clamp<std::int64_t>(whole[axis] - first[axis], 0, n))};
  }
  /// Where the original image ends along an axis: half a voxel before its first and past its last voxel centre.
  double low_border_mm(std::size_t axis) const { return -0.5 * spacing_mm[axis]; }
  double high_border_mm(std::size_t axis) const { return (static_cast<double>(whole[axis]) - 0.5) * spacing_mm[axis]; }
  /// Volume of a tissue's voxels.
  double volume_mm3(std::size_t tissue) const {
    return static_cast<double>(counts[tissue]) * spacing_mm.x * spacing_mm.y * spacing_mm.z;
  }
  /// Index in the crop, or beyond it, of the voxel that a point lies in.
  std::array<int, 3> index_at(Vec3 p_mm) const {
    std::array<int, 3> index;
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = static_cast<int>(std::lround(p_mm[a] / spacing_mm[a] - static_cast<double>(first[a])));
    return index;
  }
  Vec3 centre_mm(int i, int j, int k) const {
    return {static_cast<double>(first[0] + i) * spacing_mm.x, static_cast<double>(first[1] + j) * spacing_mm.y,
            static_cast<double>(first[2] + k) * spacing_mm.z};
  }
};

/// The chosen labels (empty: all) of an image. Throws InvalidOption when no voxel carries one of them,
/// InvalidInput when all is background, or for more than 65,535 labels or 4e9 voxels. Cost: two passes over the voxels.
TissueImage make_tissue_image(const LabelImage& image, const std::vector<Label>& chosen = {});

/// A box of an image, voxels first to first + size of the original one, which may lie beyond the crop: background
/// there. counts stay those of the whole.
TissueImage part_of(const TissueImage& image, const std::array<std::int64_t, 3>& first, const std::array<int, 3>& size);

}  // namespace anatomesh
