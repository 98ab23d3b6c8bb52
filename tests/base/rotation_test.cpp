#include "base/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/vec.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

Mat3 oblique_direction() { return testing::oblique(testing::one_voxel()).direction; }

double distance(const Mat3& a, const Mat3& b) {
  double worst = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a[r][c] - b[r][c]));
  }
  return worst;
}

Mat3 disturbed(Mat3 matrix, double by) {
  double sign = by;
  for (auto& row : matrix) {
    for (double& entry : row) entry += (sign = -0.7 * sign + 0.1 * by);
  }
  return matrix;
}

TEST(Rotation, DeviationIsThatOfTheColumnsProducts) {
  EXPECT_EQ(deviation_from_orthonormal(kIdentity3), 0);
  EXPECT_LT(deviation_from_orthonormal(oblique_direction()), 1e-14);
  EXPECT_DOUBLE_EQ(deviation_from_orthonormal({{{1, 0.5, 0}, {0, 1, 0}, {0, 0, 1}}}), 0.5);
  EXPECT_DOUBLE_EQ(deviation_from_orthonormal({{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 3);
  EXPECT_DOUBLE_EQ(deviation_from_orthonormal({}), 1);
}

TEST(Rotation, DeviationOfNanIsNan) {
  for (std::size_t n = 0; n < 9; ++n) {
    Mat3 matrix = kIdentity3;
    matrix[n / 3][n % 3] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(deviation_from_orthonormal(matrix))) << n;
  }
}

TEST(Rotation, NearestOfARotationIsItself) {
  Mat3 mirrored = oblique_direction();
  for (auto& row : mirrored) row[1] = -row[1];
  for (const Mat3& matrix : {kIdentity3, oblique_direction(), mirrored}) {
    EXPECT_LT(distance(nearest_orthonormal(matrix), matrix), 1e-14);
    EXPECT_NEAR(determinant(nearest_orthonormal(matrix)), determinant(matrix), 1e-12);
  }
}

TEST(Rotation, NearestOfANearestIsTheSameToTheLastBit) {
  double by = 3e-4;
  for (int n = 0; n < 1000; ++n, by *= 0.97) {
    const Mat3 nearest = nearest_orthonormal(disturbed(oblique_direction(), by));
    EXPECT_EQ(nearest_orthonormal(nearest), nearest) << by;
  }
}

TEST(Rotation, NearestIsOrthonormalAndNear) {
  for (const double by : {1e-9, 1e-6, 1e-4, 3e-4}) {
    const Mat3 matrix = disturbed(oblique_direction(), by);
    const Mat3 nearest = nearest_orthonormal(matrix);
    EXPECT_LT(deviation_from_orthonormal(nearest), 1e-14) << by;
    EXPECT_LT(distance(nearest, matrix), 3 * by) << by;
  }
}

}  // namespace
}  // namespace anatomesh
