#include "base/vec.h"

#include <gtest/gtest.h>

namespace anatomesh {
namespace {

constexpr Vec3 kA = {1, -2, 3}, kB = {4, 0.5, -1};

TEST(Vec3, Arithmetic) {
  EXPECT_EQ(kA + kB, (Vec3{5, -1.5, 2}));
  EXPECT_EQ(kA - kB, (Vec3{-3, -2.5, 4}));
  EXPECT_EQ(-kA, (Vec3{-1, 2, -3}));
  EXPECT_EQ(2 * kA, (Vec3{2, -4, 6}));
  EXPECT_EQ(kA * 2, 2 * kA);
  Vec3 sum = kA;
  sum += kB;
  EXPECT_EQ(sum, kA + kB);
  sum -= kB;
  EXPECT_EQ(sum, kA);
}

TEST(Vec3, Products) {
  EXPECT_EQ(dot(kA, kB), 0);
  EXPECT_EQ(cross({1, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(cross(kA, kB), -cross(kB, kA));
  EXPECT_EQ(dot(cross(kA, kB), kA), 0);
  EXPECT_EQ(norm_squared(kA), 14);
  EXPECT_DOUBLE_EQ(norm({2, 3, 6}), 7);
}

TEST(Vec3, Components) {
  Vec3 v = kA;
  for (std::size_t a = 0; a < 3; ++a) v[a] += 1;
  EXPECT_EQ(v, (Vec3{2, -1, 4}));
}

TEST(Mat3, ProductIsRowsTimesVector) {
  const Mat3 m = {{{1, 2, 3}, {0, 1, 4}, {5, 6, 0}}};
  EXPECT_EQ(m * Vec3({1, 1, 1}), (Vec3{6, 5, 11}));
  EXPECT_EQ(kIdentity3 * kA, kA);
}

TEST(Mat3, Determinant) {
  EXPECT_EQ(determinant(kIdentity3), 1);
  EXPECT_EQ(determinant({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), -1);
  EXPECT_EQ(determinant({{{1, 2, 3}, {0, 1, 4}, {5, 6, 0}}}), 1);
  EXPECT_EQ(determinant({{{1, 2, 3}, {2, 4, 6}, {5, 6, 0}}}), 0);
}

}  // namespace
}  // namespace anatomesh
