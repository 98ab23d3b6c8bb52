#include "image/local_thickness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// Thickness at the voxels of tissue 1, smallest and largest.
std::pair<float, float> range_of(const TissueImage& image, double cap_mm) {
  const std::vector<float> thickness = local_thickness(image, cap_mm, {});
  std::pair<float, float> range = {std::numeric_limits<float>::infinity(), 0};
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    if (image.voxels[v] != 1) continue;
    range.first = std::min(range.first, thickness[v]);
    range.second = std::max(range.second, thickness[v]);
  }
  return range;
}

TissueImage plate(int voxels, Vec3 spacing_mm) {
  LabelImage image =
      testing::make_image({24, 24, 24}, [&](int, int, int k) { return Label{k >= 8 && k < 8 + voxels ? 1u : 0u}; });
  image.spacing_mm = spacing_mm;
  return make_tissue_image(image);
}

TEST(LocalThickness, of_a_plate_is_its_thickness) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.5, 0.7, 2}}) {
    for (const int voxels : {1, 2, 3, 4, 5}) {
      const auto [low, high] = range_of(plate(voxels, spacing), 12);
      EXPECT_FLOAT_EQ(high, static_cast<float>(voxels * spacing.z)) << voxels;
      // At the plate's rim the ball has less room.
      EXPECT_GE(low, 0.5 * std::min(spacing.x, voxels * spacing.z)) << voxels;
    }
  }
}

TEST(LocalThickness, is_infinite_above_the_cap_and_in_the_background) {
  const TissueImage image = plate(8, {1, 1, 1});
  const std::vector<float> thickness = local_thickness(image, 6, {});
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    EXPECT_TRUE(image.voxels[v] != 0 || std::isinf(thickness[v]));
  }
  EXPECT_TRUE(std::isinf(range_of(image, 6).second));
}

TEST(LocalThickness, of_a_ball_is_its_diameter_nearly_everywhere) {
  const TissueImage image = make_tissue_image(testing::sphere(9));
  const std::vector<float> thickness = local_thickness(image, 60, {});
  std::size_t near = 0, all = 0;
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    if (image.voxels[v] == 0) continue;
    ++all;
    near += std::abs(thickness[v] - 18) < 2.5;
    EXPECT_LE(thickness[v], 20);
  }
  EXPECT_GT(static_cast<double>(near), 0.8 * static_cast<double>(all));
}

TEST(LocalThickness, does_not_depend_on_the_number_of_threads) {
  const TissueImage image = make_tissue_image(testing::vessel_tree());
  const std::vector<float> thickness = local_thickness(image, 20, {});
  const ThreadLimit one(1);
  EXPECT_EQ(thickness, local_thickness(image, 20, {}));
}

TEST(LocalThickness, stops_when_asked) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(local_thickness(make_tissue_image(testing::sphere()), 20, source.get_token()), Cancelled);
}

}  // namespace
}  // namespace anatomesh
