#include "deform/settle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/vec.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

std::vector<Vec3> random_points(Vec3 centre, double reach) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> offset(-reach, reach);
  std::vector<Vec3> points(200);
  for (Vec3& p : points) {
    const double x = offset(random), y = offset(random), z = offset(random);
    p = centre + Vec3{x, y, z};
  }
  return points;
}

Vec3 after_steps(const LabelField& field, Vec3 p, std::vector<TissueId> tissues, int steps = 40) {
  for (int n = 0; n < steps; ++n) p += boundary_step(field, p, tissues);
  return p;
}

/// Difference of the largest and the smallest share of the tissues at p.
double spread_of_shares(const LabelField& field, Vec3 p, const std::vector<TissueId>& tissues) {
  std::vector<double> shares(tissues.size());
  std::vector<Vec3> gradients(tissues.size());
  field.evaluate(p, tissues, shares, gradients);
  const auto [least, most] = std::minmax_element(shares.begin(), shares.end());
  return *most - *least;
}

void expect_convergence_to_a_plane(Vec3 spacing_mm) {
  LabelImage image =
      testing::make_image({20, 20, 20}, [](int i, int, int) { return static_cast<Label>(i < 10 ? 1 : 2); });
  image.spacing_mm = spacing_mm;
  const TissueImage tissues = make_tissue_image(image);
  const LabelField field(tissues);
  const Vec3 on_plane = {9.5 * spacing_mm.x, 10 * spacing_mm.y, 10 * spacing_mm.z};
  int converged = 0;
  for (const Vec3 from : random_points(on_plane, spacing_mm.x)) {
    const Vec3 to = after_steps(field, from, {1, 2});
    converged += std::abs(to.x - on_plane.x) < 1e-3;
    EXPECT_NEAR(to.y, from.y, 1e-6);
    EXPECT_NEAR(to.z, from.z, 1e-6);
  }
  EXPECT_EQ(converged, 200) << "of 200 points within a voxel of the plane";
}

TEST(BoundaryStep, ConvergesToThePlaneBetweenTwoTissues) { expect_convergence_to_a_plane({1, 1, 1}); }

TEST(BoundaryStep, ConvergesToAPlaneAcrossTheShortAxisOfTheVoxels) { expect_convergence_to_a_plane({0.7, 1.1, 2.5}); }

TEST(BoundaryStep, ConvergesToAPlaneAcrossTheLongAxisOfTheVoxels) { expect_convergence_to_a_plane({2.5, 1.1, 0.7}); }

TEST(BoundaryStep, ConvergesToTheSurfaceOfABall) {
  const TissueImage tissues = make_tissue_image(testing::sphere(9));
  const LabelField field(tissues);
  for (const Vec3 direction : random_points({0, 0, 0}, 1)) {
    const Vec3 centre = {11, 11, 11};
    const Vec3 to = after_steps(field, centre + (9.0 / norm(direction)) * direction, {0, 1});
    EXPECT_LT(spread_of_shares(field, to, {0, 1}), 1e-3);
    EXPECT_NEAR(norm(to - centre), 9.2, 0.6);
  }
}

TEST(BoundaryStep, ConvergesToTheJunctionLineOfThreeTissues) {
  const LabelImage image = testing::make_image({20, 20, 20}, [](int i, int j, int) {
    return static_cast<Label>(i < 10 ? 1 : j < 10 ? 2 : 3);
  });
  const TissueImage tissues = make_tissue_image(image);
  const LabelField field(tissues);
  for (const Vec3 from : random_points({9.5, 9.5, 10}, 0.9)) {
    const Vec3 to = after_steps(field, from, {1, 2, 3});
    EXPECT_LT(spread_of_shares(field, to, {1, 2, 3}), 1e-3);
    EXPECT_NEAR(to.x, 9.5, 0.6);
    EXPECT_NEAR(to.y, 9.5, 1e-3);
    EXPECT_NEAR(to.z, from.z, 1e-6);
  }
}

TEST(BoundaryStep, StaysFarFromTheBoundary) {
  const TissueImage tissues = make_tissue_image(testing::sphere(9));
  const LabelField field(tissues);
  const std::vector<TissueId> pair = {0, 1};
  EXPECT_EQ(boundary_step(field, {11, 11, 11}, pair), Vec3{});
  EXPECT_EQ(boundary_step(field, {-50, 11, 11}, pair), Vec3{});
}

TEST(BoundaryStep, IsAtMostHalfAVoxelAlongEachAxis) {
  const TissueImage tissues = make_tissue_image(testing::anisotropic(testing::noise(1)));
  const LabelField field(tissues);
  const std::vector<TissueId> three = {1, 2, 3};
  for (const Vec3 p : random_points({3, 4, 10}, 5)) {
    const Vec3 step = boundary_step(field, p, three);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::abs(step[a]), 0.5 * tissues.spacing_mm[a] + 1e-9);
  }
}

}  // namespace
}  // namespace anatomesh
