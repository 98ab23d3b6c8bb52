// The fast ways to what is nearest, against looking at everything.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "assess/box_tree.h"
#include "assess/facet.h"
#include "assess/point_grid.h"
#include "assess/statistics.h"
#include "assess/voxel_surface.h"
#include "base/vec.h"
#include "support/test_images.h"

namespace anatomesh::assess_detail {
namespace {

constexpr double kFar = 1e300;

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(generator_()) / 4294967295.0);
  }
  Vec3 point(double low, double high) { return {(*this)(low, high), (*this)(low, high), (*this)(low, high)}; }

 private:
  std::mt19937 generator_;
};

/// Distance to a triangle by a fine grid of its points: never below the true one, and above it by at most the step.
double sampled_distance(const Facet& f, Vec3 p) {
  constexpr int kSteps = 200;
  double best = kFar;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const double u = double{1} * i / kSteps, v = double{1} * j / kSteps;
      best = std::min(best, norm_squared(p - (f.a + u * (f.b - f.a) + v * (f.c - f.a))));
    }
  }
  return std::sqrt(best);
}

TEST(Facet, DistanceAgreesWithSamples) {
  Random random(1);
  for (int n = 0; n < 200; ++n) {
    const Facet f(random.point(0, 1), random.point(0, 1), random.point(0, 1));
    const Vec3 p = random.point(-1, 2);
    const double exact = std::sqrt(f.distance_squared(p, kFar));
    const double sampled = sampled_distance(f, p);
    EXPECT_LE(exact, sampled + 1e-12);
    EXPECT_GE(exact, sampled - 0.01);
  }
}

TEST(Facet, WithoutAreaIsASegmentOrAPoint) {
  const Facet segment({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_DOUBLE_EQ(segment.distance_squared({1.5, 2, 0}, kFar), 4);
  EXPECT_DOUBLE_EQ(segment.distance_squared({3, 0, 0}, kFar), 1);
  const Facet point({1, 1, 1}, {1, 1, 1}, {1, 1, 1});
  EXPECT_DOUBLE_EQ(point.distance_squared({1, 1, 4}, kFar), 9);
}

TEST(BoxTree, NearestTriangleAgreesWithAllOfThem) {
  Random random(2);
  for (const std::size_t count : {1u, 3u, 4u, 5u, 17u, 1000u, 20000u}) {
    std::vector<Facet> facets;
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 a = random.point(0, 10);
      const Facet& f = facets.emplace_back(a, a + random.point(-0.5, 0.5), a + random.point(-0.5, 0.5));
      boxes.push_back(Box::empty());
      for (const Vec3 p : {f.a, f.b, f.c}) boxes.back().include(p);
    }
    const BoxTree tree(boxes);
    for (int q = 0; q < 100; ++q) {
      const Vec3 p = random.point(-2, 12);
      double nearest = kFar, brute = kFar;
      tree.nearer_than(p, kFar, [&](std::size_t n, double& reach) {
        const double d = facets[tree.order()[n]].distance_squared(p, reach);
        if (d < reach) nearest = reach = d;
      });
      for (const Facet& f : facets) brute = std::min(brute, f.distance_squared(p, brute));
      EXPECT_EQ(nearest, brute);
    }
  }
}

TEST(BoxTree, WithoutItemsVisitsNone) {
  BoxTree({}).nearer_than({0, 0, 0}, kFar, [](std::size_t, double&) { FAIL(); });
}

TEST(PointGrid, FindsWhatIsWithinTheRadius) {
  Random random(3);
  for (const double flatness : {1.0, 1e-3, 0.0}) {
    std::vector<Vec3> points;
    std::vector<VertexId> ids;
    for (VertexId v = 0; v < 3000; ++v) {
      const Vec3 p = random.point(0, 1);
      points.push_back({p.x, p.y, flatness * p.z});
      if (v % 3 != 0) ids.push_back(v);
    }
    const PointGrid grid(points, ids);
    for (int q = 0; q < 200; ++q) {
      const Vec3 p = random.point(-0.1, 1.1);
      const double radius = random(0, 0.2);
      std::vector<VertexId> found, brute;
      grid.within(p, radius, [&](VertexId v) { found.push_back(v); });
      std::sort(found.begin(), found.end());
      for (const VertexId v : ids) {
        if (norm(points[v] - p) <= radius) brute.push_back(v);
      }
      EXPECT_EQ(found, brute);
    }
  }
}

/// Squared distance to the boundary squares, one by one.
double brute_distance(const std::vector<VoxelSide>& sides, Vec3 spacing, Vec3 p) {
  double best = kFar;
  for (const VoxelSide& s : sides) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool across = a == static_cast<std::size_t>(s.axis);
      const double low = (s.voxel[a] + (across ? 0.5 : -0.5)) * spacing[a], high = (s.voxel[a] + 0.5) * spacing[a];
      const double d = std::max({low - p[a], p[a] - high, 0.0});
      sum += d * d;
    }
    best = std::min(best, sum);
  }
  return best;
}

TEST(VoxelDistance, AgreesWithEverySide) {
  Random random(4);
  for (const auto& image : {testing::noise(5, 8, 1), testing::sphere(7), testing::one_voxel(),
                            testing::anisotropic(testing::vessel_tree())}) {
    VoxelRange range;
    for (std::int64_t k = 0; k < static_cast<std::int64_t>(image.size[2]); ++k) {
      for (std::int64_t j = 0; j < static_cast<std::int64_t>(image.size[1]); ++j) {
        for (std::int64_t i = 0; i < static_cast<std::int64_t>(image.size[0]); ++i) {
          if (image.voxels[static_cast<std::size_t>(i) +
                           image.size[0] *
                               (static_cast<std::size_t>(j) + image.size[1] * static_cast<std::size_t>(k))] != 0) {
            range.include({{i, j, k}, {i, j, k}});
          }
        }
      }
    }
    const VoxelBlock block = cut_out(image, range, 0);
    const VoxelDistance distance(block, image.spacing_mm);
    const auto sides = boundary_of(block);
    for (int q = 0; q < 2000; ++q) {
      const Vec3 p = random.point(-12, 45);
      const double brute = brute_distance(sides, image.spacing_mm, p);
      EXPECT_NEAR(distance.distance_squared(p, kFar), brute, 1e-12 * (1 + brute));
      EXPECT_NEAR(distance.distance_squared(p, brute * 1.01 + 1e-9), brute, 1e-12 * (1 + brute));
    }
  }
}

TEST(Statistics, PercentileInterpolates) {
  std::vector<double> values = {4, 1, 3, 2, 5};
  EXPECT_DOUBLE_EQ(percentile(values, 0), 1);
  EXPECT_DOUBLE_EQ(percentile(values, 50), 3);
  EXPECT_DOUBLE_EQ(percentile(values, 95), 4.8);
  EXPECT_DOUBLE_EQ(percentile(values, 100), 5);
  std::vector<double> none;
  EXPECT_TRUE(std::isnan(percentile(none, 50)));
}

TEST(Statistics, WeightedQuantileAgreesWithSorting) {
  Random random(5);
  for (const std::size_t count : {1u, 2u, 7u, 500u}) {
    std::vector<Weighted> values;
    for (std::size_t i = 0; i < count; ++i) {
      const float weight = i % 4 == 3 ? 0 : static_cast<float>(std::floor(random(1, 9)));  // sums without rounding
      values.push_back({static_cast<float>(random(0, 1)), weight});
    }
    auto sorted = values;
    std::sort(sorted.begin(), sorted.end(), [](auto a, auto b) { return a.value < b.value; });
    double whole = 0, sum = 0;
    for (const Weighted& v : values) whole += v.weight;
    for (const double share : {0.05, 0.5, 0.95}) {
      std::size_t at = 0;
      for (sum = sorted[0].weight; sum < share * whole;) sum += sorted[++at].weight;
      EXPECT_EQ(weighted_quantile(values, share), sorted[at].value);
    }
  }
  std::vector<Weighted> weightless = {{1, 0}, {3, 0}, {2, 0}};
  EXPECT_EQ(weighted_quantile(weightless, 0.5), 2);
}

}  // namespace
}  // namespace anatomesh::assess_detail
