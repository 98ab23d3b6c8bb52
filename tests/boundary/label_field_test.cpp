#include "boundary/label_field.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "base/vec.h"
#include "boundary/finite_differences.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

// The centred cubic B-spline, as in the textbook.
double spline(double x) {
  x = std::abs(x);
  if (x < 1) return (4 - 6 * x * x + 3 * x * x * x) / 6;
  return x < 2 ? (2 - x) * (2 - x) * (2 - x) / 6 : 0;
}

// u_t(p) by its definition: a sum over all voxels of the crop and a margin of background.
double brute_force(const TissueImage& image, TissueId tissue, Vec3 p) {
  double sum = 0;
  for (int k = -8; k < image.size[2] + 8; ++k) {
    for (int j = -8; j < image.size[1] + 8; ++j) {
      for (int i = -8; i < image.size[0] + 8; ++i) {
        if (image.at_or_background(i, j, k) != tissue) continue;
        const Vec3 d = p - image.centre_mm(i, j, k);
        const Vec3 s = image.spacing_mm;
        sum += spline(d.x / s.x) * spline(d.y / s.y) * spline(d.z / s.z);
      }
    }
  }
  return sum;
}

// Points in the crop and up to four voxels outside of it.
std::vector<Vec3> points_around(const TissueImage& image, int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 first = image.centre_mm(-4, -4, -4);
  const Vec3 last = image.centre_mm(image.size[0] + 3, image.size[1] + 3, image.size[2] + 3);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    points.push_back(
        {first.x + x * (last.x - first.x), first.y + y * (last.y - first.y), first.z + z * (last.z - first.z)});
  }
  return points;
}

std::vector<TissueId> all_tissues(const TissueImage& image) {
  std::vector<TissueId> tissues;
  for (std::size_t t = 0; t < image.labels.size(); ++t) tissues.push_back(static_cast<TissueId>(t));
  return tissues;
}

TEST(LabelField, ValuesAreThoseOfTheDefinition) {
  for (const LabelImage& labels : {testing::noise(1), testing::anisotropic(testing::labels_at_border())}) {
    const TissueImage image = make_tissue_image(labels);
    const LabelField field(image);
    const std::vector<TissueId> tissues = all_tissues(image);
    std::vector<double> values(tissues.size());
    std::vector<Vec3> gradients(tissues.size());
    for (const Vec3 p : points_around(image, 40)) {
      field.evaluate(p, tissues, values, gradients);
      for (std::size_t t = 0; t < tissues.size(); ++t) EXPECT_NEAR(values[t], brute_force(image, tissues[t], p), 1e-12);
    }
  }
}

TEST(LabelField, ValuesOfAllTissuesAddUpToOneAndGradientsToZero) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::four_label_point()));
  const LabelField field(image);
  const std::vector<TissueId> tissues = all_tissues(image);
  std::vector<double> values(tissues.size());
  std::vector<Vec3> gradients(tissues.size());
  for (const Vec3 p : points_around(image, 1000)) {
    field.evaluate(p, tissues, values, gradients);
    double sum = 0;
    Vec3 gradient;
    for (std::size_t t = 0; t < tissues.size(); ++t) {
      sum += values[t];
      gradient += gradients[t];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT(norm(gradient), 1e-12);
  }
}

TEST(LabelField, GradientsAreThoseOfFiniteDifferences) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::noise(5)));
  const LabelField field(image);
  const std::vector<TissueId> tissues = all_tissues(image);
  for (const Vec3 p : points_around(image, 200))
    testing::expect_gradients_of_finite_differences(field, tissues, p, 1e-8);
}

TEST(LabelField, LabelIsTheTissueWithTheLargestValue) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const TissueImage image = make_tissue_image(testing::noise(seed, 8, 20));
    const LabelField field(image);
    const std::vector<TissueId> tissues = all_tissues(image);
    std::vector<double> values(tissues.size());
    std::vector<Vec3> gradients(tissues.size());
    for (const Vec3 p : points_around(image, 2000)) {
      field.evaluate(p, tissues, values, gradients);
      std::size_t best = 0;
      for (std::size_t t = 1; t < tissues.size(); ++t) {
        if (values[t] > values[best] + 1e-12) best = t;
      }
      EXPECT_EQ(field.label_at(p), tissues[best]);
    }
  }
}

TEST(LabelField, TiesGoToTheLowestTissue) {
  const LabelImage labels =
      testing::make_image({12, 12, 12}, [](int i, int, int) { return static_cast<Label>(i < 6 ? 2 : 1); });
  const TissueImage image = make_tissue_image(labels);
  EXPECT_EQ(LabelField(image).label_at({5.5, 6, 6}), 1);
  EXPECT_EQ(LabelField(image).label_at({5.49, 6, 6}), 2);
}

TEST(LabelField, ThinSheetKeepsItsPlace) {
  const TissueImage image = make_tissue_image(
      testing::make_image({9, 9, 9}, [](int, int, int k) { return static_cast<Label>(k == 4 ? 1 : 0); }));
  const LabelField field(image);
  EXPECT_EQ(field.label_at({4, 4, 4}), 1);
  EXPECT_EQ(field.label_at({4, 4, 4.45}), 1);
  EXPECT_EQ(field.label_at({4, 4, 4.55}), 0);
}

TEST(LabelField, FarAwayIsBackground) {
  const TissueImage image = make_tissue_image(testing::no_background_box());
  const LabelField field(image);
  for (const Vec3 p : {Vec3{1e30, 0, 0}, Vec3{0, -1e30, 0}, Vec3{5, 5, -300}}) {
    const std::array<TissueId, 2> tissues = {0, 1};
    std::array<double, 2> values;
    std::array<Vec3, 2> gradients;
    field.evaluate(p, tissues, values, gradients);
    EXPECT_EQ(field.label_at(p), 0);
    EXPECT_NEAR(values[0], 1, 1e-15);
    EXPECT_EQ(values[1], 0);
    EXPECT_LT(norm(gradients[0]), 1e-15);
  }
}

}  // namespace
}  // namespace anatomesh
