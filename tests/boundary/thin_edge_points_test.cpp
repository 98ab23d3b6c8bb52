#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "base/parallel.h"
#include "boundary/edge_points.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

// How many axes the voxels may differ in and still touch: 3 vertex, 2 edge, 1 face.
struct Pattern {
  NonConnectivity pattern;
  int axes;
};
constexpr std::array<Pattern, 3> kPatterns = {
    {{NonConnectivity::vertex, 3}, {NonConnectivity::edge, 2}, {NonConnectivity::face, 1}}};

bool touch(const EdgePoint& a, const EdgePoint& b, int axes) {
  if (a.pair != b.pair) return false;
  int differing = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int d = std::abs(a.voxel[axis] - b.voxel[axis]);
    if (d > 1) return false;
    differing += d;
  }
  return differing <= axes;
}

bool contains(const std::vector<EdgePoint>& points, const EdgePoint& point) {
  return std::find(points.begin(), points.end(), point) != points.end();
}

// Points of three pairs in a small block of voxels, ordered by voxel.
std::vector<EdgePoint> random_points(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<EdgePoint> points;
  for (int k = 0; k < 9; ++k) {
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 11; ++i) {
        for (TissueId high = 1; high < 4; ++high) {
          if (random() % 3 != 0) continue;
          points.push_back(
              {{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}, {0, high}, {i, j, k}});
        }
      }
    }
  }
  return points;
}

TEST(ThinEdgePoints, ChosenPointsDoNotTouchAndNoneCouldBeAdded) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const std::vector<EdgePoint> points = random_points(seed);
    for (const Pattern& p : kPatterns) {
      const std::vector<EdgePoint> kept = thin_edge_points(points, p.pattern);
      for (std::size_t a = 0; a < kept.size(); ++a) {
        for (std::size_t b = a + 1; b < kept.size(); ++b) EXPECT_FALSE(touch(kept[a], kept[b], p.axes));
      }
      for (const EdgePoint& point : points) {
        if (contains(kept, point)) continue;
        EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [&](const EdgePoint& k) { return touch(k, point, p.axes); }));
      }
    }
  }
}

TEST(ThinEdgePoints, StrongerPatternsKeepFewer) {
  for (const testing::NamedImage& test : testing::all_shapes()) {
    SCOPED_TRACE(test.name);
    const std::vector<EdgePoint> points = find_edge_points(make_tissue_image(test.image));
    const std::size_t vertex = thin_edge_points(points, NonConnectivity::vertex).size();
    const std::size_t edge = thin_edge_points(points, NonConnectivity::edge).size();
    const std::size_t face = thin_edge_points(points, NonConnectivity::face).size();
    EXPECT_LE(1u, vertex);
    EXPECT_LE(vertex, edge);
    EXPECT_LE(edge, face);
    EXPECT_LE(face, points.size());
    EXPECT_EQ(thin_edge_points(points, NonConnectivity::none), points);
  }
}

TEST(ThinEdgePoints, ChoiceDoesNotDependOnTheOrderGiven) {
  const std::vector<EdgePoint> points = random_points(11);
  std::vector<EdgePoint> shuffled = points;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(1));
  for (const Pattern& p : kPatterns) {
    const std::vector<EdgePoint> kept = thin_edge_points(points, p.pattern);
    const std::vector<EdgePoint> kept_shuffled = thin_edge_points(shuffled, p.pattern);
    EXPECT_EQ(kept.size(), kept_shuffled.size());
    for (const EdgePoint& point : kept) EXPECT_TRUE(contains(kept_shuffled, point));
  }
}

TEST(ThinEdgePoints, OneVoxelKeepsOnePointOfAPair) {
  const std::vector<EdgePoint> points = {{{1, 1, 1}, {0, 1}, {1, 1, 1}}, {{1.2, 1, 1}, {0, 1}, {1, 1, 1}}};
  for (const Pattern& p : kPatterns) EXPECT_EQ(thin_edge_points(points, p.pattern).size(), 1u);
}

TEST(ThinEdgePoints, DoNotDependOnTheNumberOfThreads) {
  const std::vector<EdgePoint> points = random_points(2);
  const ThreadLimit limit(1);
  const std::vector<EdgePoint> one = thin_edge_points(points, NonConnectivity::edge);
  const ThreadLimit more(5);
  EXPECT_EQ(one, thin_edge_points(points, NonConnectivity::edge));
}

}  // namespace
}  // namespace anatomesh
