#include "mesh/vertices_by_point.h"

#include <gtest/gtest.h>

#include <cmath>

namespace anatomesh {
namespace {

TEST(VerticesByPoint, AreFoundExactlyWhereTheyAre) {
  VerticesByPoint vertices;
  vertices.add({0, 1, 2}, 7);
  vertices.add({0, 2, 1}, 8);
  vertices.add({-0.0, 1, 2}, 9);
  EXPECT_EQ(vertices.at({0, 1, 2}), 7u);
  EXPECT_EQ(vertices.at({-0.0, 1, 2}), 7u);
  EXPECT_EQ(vertices.at({0, 2, 1}), 8u);
  EXPECT_EQ(vertices.at({0, 1, std::nextafter(2.0, 3.0)}), std::nullopt);
}

}  // namespace
}  // namespace anatomesh
