#include "image/tissue_image.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <random>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

constexpr int kBorder = TissueImage::kBorder;

/// A voxel of the image that was given, 0 outside.
Label label_at(const LabelImage& image, std::int64_t i, std::int64_t j, std::int64_t k) {
  const std::array<std::int64_t, 3> at = {i, j, k};
  for (std::size_t a = 0; a < 3; ++a) {
    if (at[a] < 0 || at[a] >= static_cast<std::int64_t>(image.size[a])) return 0;
  }
  return image.at(static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k));
}

/// Every voxel of the crop against the image; everything labelled is in the crop.
void expect_same_voxels(const TissueImage& tissues, const LabelImage& image) {
  std::map<Label, std::uint64_t> counts, expected;
  for (int k = 0; k < tissues.size[2]; ++k) {
    for (int j = 0; j < tissues.size[1]; ++j) {
      for (int i = 0; i < tissues.size[0]; ++i) {
        const Label label = tissues.labels[tissues.at(i, j, k)];
        EXPECT_EQ(label, label_at(image, tissues.first[0] + i, tissues.first[1] + j, tissues.first[2] + k));
        ++counts[label];
      }
    }
  }
  for (const Label label : image.voxels) ++expected[label];
  ASSERT_EQ(tissues.counts.size(), tissues.labels.size());
  for (std::size_t t = 0; t < tissues.labels.size(); ++t) {
    EXPECT_EQ(tissues.counts[t], counts[tissues.labels[t]]);
    if (t > 0) {
      EXPECT_EQ(tissues.counts[t], expected[tissues.labels[t]]);
    }
  }
}

TEST(TissueImage, HoldsTheVoxelsOfEveryImage) {
  for (const auto& [name, image] : testing::all_test_images()) {
    SCOPED_TRACE(name);
    const TissueImage tissues = make_tissue_image(image);
    expect_same_voxels(tissues, image);
    EXPECT_EQ(tissues.spacing_mm, image.spacing_mm);
  }
}

TEST(TissueImage, LabelsAreAscendingAfterTheBackground) {
  const TissueImage tissues = make_tissue_image(testing::nested_spheres());
  EXPECT_EQ(tissues.labels, (std::vector<Label>{0, 3, 70000, 4294967295u}));
  EXPECT_EQ(tissues.tissue_count(), 3u);
}

TEST(TissueImage, IsCroppedToTheLabelsAndABorder) {
  const LabelImage image = testing::make_image({30, 20, 10}, [](int i, int j, int k) {
    return Label{(i == 12 && j == 3 && k == 9) || (i == 15 && j == 7 && k == 5)};
  });
  const TissueImage tissues = make_tissue_image(image);
  EXPECT_EQ(tissues.size, (std::array{4 + 2 * kBorder, 5 + 2 * kBorder, 5 + 2 * kBorder}));
  EXPECT_EQ(tissues.first, (std::array<std::int64_t, 3>{12 - kBorder, 3 - kBorder, 5 - kBorder}));
  EXPECT_EQ(tissues.at(kBorder, kBorder, kBorder + 4), 1);
  expect_same_voxels(tissues, image);
}

TEST(TissueImage, BorderMayLieOutsideTheImage) {
  const TissueImage tissues = make_tissue_image(testing::only_one_voxel());
  EXPECT_EQ(tissues.size, (std::array{1 + 2 * kBorder, 1 + 2 * kBorder, 1 + 2 * kBorder}));
  EXPECT_EQ(tissues.first, (std::array<std::int64_t, 3>{-kBorder, -kBorder, -kBorder}));
  EXPECT_EQ(tissues.labels, (std::vector<Label>{0, 9}));
  EXPECT_EQ(tissues.at(kBorder, kBorder, kBorder), 1);
}

TEST(TissueImage, CentresAreThoseOfTheImage) {
  const LabelImage image = testing::anisotropic(testing::one_voxel());
  const TissueImage tissues = make_tissue_image(image);
  EXPECT_EQ(tissues.centre_mm(kBorder, kBorder, kBorder), (Vec3{3 * 0.7, 3 * 1.1, 3 * 2.5}));
}

TEST(TissueImage, OutsideTheCropIsBackground) {
  const TissueImage tissues = make_tissue_image(testing::only_one_voxel());
  EXPECT_FALSE(tissues.contains(-1, 0, 0));
  EXPECT_FALSE(tissues.contains(0, 0, tissues.size[2]));
  EXPECT_EQ(tissues.at_or_background(-1, 0, 0), 0);
  EXPECT_EQ(tissues.at_or_background(kBorder, kBorder, kBorder), 1);
}

TEST(TissueImage, ChosenLabelsOnly) {
  LabelImage image = testing::three_label_junction();
  const TissueImage chosen = make_tissue_image(image, {300, 1, 1});
  EXPECT_EQ(chosen.labels, (std::vector<Label>{0, 1, 300}));
  for (Label& label : image.voxels) label = label == 2 ? 0 : label;
  expect_same_voxels(chosen, image);
}

TEST(TissueImage, ManyLabelsKeepTheirValues) {
  std::mt19937 random(1);
  const LabelImage image = testing::make_image(
      {20, 20, 20}, [&](int, int, int) { return static_cast<Label>(random() % 3 == 0 ? 0 : random()); });
  expect_same_voxels(make_tissue_image(image), image);
}

LabelImage numbered(std::size_t voxels) {
  LabelImage image;
  image.size = {voxels, 1, 1};
  image.voxels.resize(voxels);
  std::iota(image.voxels.begin(), image.voxels.end(), Label{7});
  return image;
}

TEST(TissueImage, AsManyLabelsAsNumbersForThem) {
  const TissueImage tissues = make_tissue_image(numbered(65535));
  EXPECT_EQ(tissues.tissue_count(), 65535u);
  EXPECT_EQ(tissues.at(kBorder + 65534, kBorder, kBorder), 65535);
  EXPECT_THROW(make_tissue_image(numbered(65536)), InvalidInput);
}

TEST(TissueImage, BackgroundOnlyIsRefused) {
  const LabelImage empty = testing::make_image({3, 3, 3}, [](int, int, int) { return Label{0}; });
  EXPECT_THROW(make_tissue_image(empty), InvalidInput);
  EXPECT_THROW(make_tissue_image(testing::sphere(), {2}), InvalidInput);
}

TEST(TissueImage, DoesNotDependOnTheNumberOfThreads) {
  const LabelImage image = testing::noise(9, 30, 50);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return make_tissue_image(image);
  };
  const TissueImage one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.voxels, four.voxels);
  EXPECT_EQ(one.counts, four.counts);
}

TEST(TissueImage, KnowsWhereTheImageEnds) {
  // Labelled voxels touch the image's border along j only.
  LabelImage image = testing::make_image(
      {20, 9, 14}, [](int i, int, int k) { return static_cast<Label>(i > 6 && i < 10 && k == 7 ? 1 : 0); });
  image.spacing_mm = {2, 3, 0.5};
  const TissueImage tissues = make_tissue_image(image);
  EXPECT_EQ(tissues.inside(0), std::pair(0, tissues.size[0]));
  EXPECT_EQ(tissues.inside(1), std::pair(kBorder, kBorder + 9));
  EXPECT_EQ(tissues.inside(2), std::pair(0, tissues.size[2]));
  EXPECT_EQ(tissues.low_border_mm(1), -1.5);
  EXPECT_EQ(tissues.high_border_mm(1), 25.5);
  EXPECT_EQ(tissues.high_border_mm(0), 39);
}

}  // namespace
}  // namespace anatomesh
