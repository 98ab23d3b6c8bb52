#include "boundary/surface_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/vec.h"
#include "boundary/finite_differences.h"
#include "boundary/label_field.h"
#include "boundary/voxel_weights.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// u_1 - u_0 at p.
template <class Field>
double difference(const Field& field, Vec3 p) {
  const std::array<TissueId, 2> tissues = {0, 1};
  std::array<double, 2> values;
  std::array<Vec3, 2> gradients;
  field.evaluate(p, tissues, values, gradients);
  return values[1] - values[0];
}

/// Where the boundary of tissue 1 lies on the ray from inside.
template <class Field>
double radius_along(const Field& field, Vec3 inside, Vec3 direction, double far) {
  double near = 0;
  for (int n = 0; n < 40; ++n) {
    const double middle = 0.5 * (near + far);
    (difference(field, inside + middle * direction) > 0 ? near : far) = middle;
  }
  return 0.5 * (near + far);
}

TEST(SurfaceField, GradientsAreThoseOfFiniteDifferences) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::noise(5)));
  const SurfaceField field(image);
  const std::array<TissueId, 4> tissues = {0, 1, 2, 3};
  for (double x = -2; x < 8; x += 0.37) {
    testing::expect_gradients_of_finite_differences(field, tissues, {x, 3.1 + 0.5 * x, 4.3 - 0.7 * x}, 1e-7);
  }
}

TEST(SurfaceField, APlaneStaysWhereItIs) {
  const TissueImage image =
      make_tissue_image(testing::make_image({20, 20, 20}, [](int i, int, int) { return static_cast<Label>(i < 10); }));
  const SurfaceField field(image);
  EXPECT_NEAR(difference(field, {9.5, 10, 10}), 0, 1e-12);
  EXPECT_GT(difference(field, {9.4, 10, 10}), 0);
}

/// How far the boundary of tissues on both sides of y = 12 + 0.2 (x - 16) waves.
template <class Field>
double waves(const Field& field) {
  double least = 1, most = -1;
  for (double x = 8; x < 24; x += 0.25) {
    const double off = radius_along(field, {x, 4, 6}, {0, 1, 0}, 20) + 4 - 12 - 0.2 * (x - 16);
    least = std::min(least, off);
    most = std::max(most, off);
  }
  return most - least;
}

TEST(SurfaceField, ASlopeIsStraighterThanItsStaircase) {
  const TissueImage image = make_tissue_image(
      testing::make_image({32, 32, 12}, [](int i, int j, int) { return static_cast<Label>(j - 12 < 0.2 * (i - 16)); }));
  EXPECT_LT(waves(SurfaceField(image)), 0.85 * waves(LabelField(image)));
}

template <class Field>
double mean_radius(const Field& field, Vec3 centre) {
  double sum = 0;
  int count = 0;
  for (double z = -0.95; z < 1; z += 0.1) {
    for (double turn = 0; turn < 6.28; turn += 0.3, ++count) {
      const double across = std::sqrt(1 - z * z);
      sum += radius_along(field, centre, {across * std::cos(turn), across * std::sin(turn), z}, 8);
    }
  }
  return sum / count;
}

TEST(SurfaceField, ABallKeepsItsRadius) {
  const TissueImage image = make_tissue_image(testing::make_image(
      {20, 20, 20}, [](int i, int j, int k) { return static_cast<Label>(std::hypot(i - 9.5, j - 9.5, k - 9.5) < 5); }));
  const double of_voxels = std::cbrt(static_cast<double>(image.counts[1]) * 3 / (4 * 3.14159265358979));
  EXPECT_NEAR(mean_radius(SurfaceField(image), {9.5, 9.5, 9.5}), of_voxels, 0.1);
}

TEST(SurfaceField, ThinLinesKeepTheirVoxelsAndSingleOnesDoNot) {
  const TissueImage image = make_tissue_image(testing::make_image({20, 20, 20}, [](int i, int j, int k) {
    return static_cast<Label>((j == 5 && k == 5 && i > 3 && i < 16) || (i == 10 && j == 14 && k == 14) || k == 18);
  }));
  const SurfaceField field(image);
  for (int i = 5; i < 15; ++i) EXPECT_GT(difference(field, {static_cast<double>(i), 5, 5}), 0.1);
  EXPECT_LT(difference(field, {10, 14, 14}), 0);
  EXPECT_GT(difference(field, {10, 10, 18}), 0.05) << "a sheet";
}

TEST(SurfaceField, GoesOnAtTheBorderOfTheImage) {
  const TissueImage image = make_tissue_image(
      testing::make_image({12, 12, 12}, [](int i, int j, int) { return static_cast<Label>(i + j < 12 ? 1 : 0); }));
  const SurfaceField field(image);
  EXPECT_GT(difference(field, {-0.5, 4, 4}), 0.9);
  EXPECT_NEAR(difference(field, {5.7, 5.1, -0.4}), difference(field, {5.7, 5.1, 5}), 1e-12);
  EXPECT_NEAR(difference(field, {5.7, 5.1, -0.4}), difference(field, {5.7, 5.1, -0.6}), 1e-12);
}

TEST(VoxelWeights, AreOneAwayFromBoundariesAndDoNotDependOnTheNumberOfThreads) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::random_blobs(7)));
  const std::vector<std::uint8_t> weights = voxel_weights(image);
  EXPECT_EQ(weights[image.offset(0, 0, 0)], kWeightUnit);
  EXPECT_TRUE(std::ranges::any_of(weights, [](std::uint8_t w) { return w != kWeightUnit; }));
  const ThreadLimit one(1);
  EXPECT_EQ(voxel_weights(image), weights);
}

}  // namespace
}  // namespace anatomesh
