#include "benchmarks/cgal_mesh_3/cgal_image.h"

#include <algorithm>
#include <cstdint>

#include "anatomesh/errors.h"

namespace anatomesh::peers {
namespace {

constexpr std::ptrdiff_t kMargin_vox = 4;
constexpr std::size_t kMostLabels = 65535;

struct Box {
  std::array<std::ptrdiff_t, 3> low, high;  ///< inclusive
};

Box labelled_box(const LabelImage& image) {
  constexpr std::ptrdiff_t kFar = PTRDIFF_MAX;
  Box box{{kFar, kFar, kFar}, {-1, -1, -1}};
  std::size_t voxel = 0;
  for (std::size_t k = 0; k < image.size[2]; ++k) {
    for (std::size_t j = 0; j < image.size[1]; ++j) {
      for (std::size_t i = 0; i < image.size[0]; ++i, ++voxel) {
        if (image.voxels[voxel] == 0) continue;
        const std::array<std::size_t, 3> index = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          box.low[a] = std::min(box.low[a], static_cast<std::ptrdiff_t>(index[a]));
          box.high[a] = std::max(box.high[a], static_cast<std::ptrdiff_t>(index[a]));
        }
      }
    }
  }
  if (box.high[0] < 0) throw InvalidInput("the image has no label but 0");
  return box;
}

std::vector<Label> labels_of(const LabelImage& image) {
  std::vector<Label> labels = {0};
  Label last = 0;
  for (const Label label : image.voxels) {
    if (label == last) continue;
    last = label;
    const auto place = std::lower_bound(labels.begin(), labels.end(), label);
    if (place == labels.end() || *place != label) labels.insert(place, label);
  }
  if (labels.size() > kMostLabels + 1) throw InvalidInput("the image has more than 65,535 labels");
  return labels;
}

/// Copies the rows of the box; what lies outside the image stays 0.
template <class Word>
void fill(Word* words, const std::array<std::size_t, 3>& size, const LabelImage& image, const CgalImage& crop,
          const Box& box) {
  std::fill(words, words + size[0] * size[1] * size[2], Word{0});
  for (std::ptrdiff_t k = box.low[2]; k <= box.high[2]; ++k) {
    for (std::ptrdiff_t j = box.low[1]; j <= box.high[1]; ++j) {
      const auto row =
          static_cast<std::size_t>(j - crop.corner_vox[1]) + size[1] * static_cast<std::size_t>(k - crop.corner_vox[2]);
      for (std::ptrdiff_t i = box.low[0]; i <= box.high[0]; ++i) {
        const Label label =
            image.at(static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k));
        const auto number = std::lower_bound(crop.labels.begin(), crop.labels.end(), label) - crop.labels.begin();
        words[static_cast<std::size_t>(i - crop.corner_vox[0]) + size[0] * row] = static_cast<Word>(number);
      }
    }
  }
}

}  // namespace

CgalImage make_cgal_image(const LabelImage& image) {
  const Box box = labelled_box(image);
  CgalImage crop;
  crop.labels = labels_of(image);
  crop.wide = crop.labels.size() > 256;
  std::array<std::size_t, 3> size{};
  for (std::size_t a = 0; a < 3; ++a) {
    crop.corner_vox[a] = box.low[a] - kMargin_vox;
    size[a] = static_cast<std::size_t>(box.high[a] - box.low[a] + 1 + 2 * kMargin_vox);
  }
  const Vec3 spacing = image.spacing_mm;
  _image* words = ::_createImage(size[0], size[1], size[2], 1, spacing.x, spacing.y, spacing.z, crop.wide ? 2 : 1,
                                 WK_FIXED, SGN_UNSIGNED);
  if (words == nullptr) throw MeshingFailed("CGAL has no memory for the image");
  crop.image = CGAL::Image_3(words);
  if (crop.wide)
    fill(static_cast<std::uint16_t*>(crop.image.data()), size, image, crop, box);
  else
    fill(static_cast<std::uint8_t*>(crop.image.data()), size, image, crop, box);
  return crop;
}

}  // namespace anatomesh::peers
