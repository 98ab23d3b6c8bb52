#include "boundary/edge_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "shapes.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

// Centres, in voxels of the crop, of the voxel faces between two tissues.
std::map<TissuePair, std::vector<Vec3>> faces_by_pair(const TissueImage& image) {
  std::map<TissuePair, std::vector<Vec3>> faces;
  for (int k = 0; k < image.size[2]; ++k) {
    for (int j = 0; j < image.size[1]; ++j) {
      for (int i = 0; i < image.size[0]; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const TissueId a = image.at(i, j, k);
          const TissueId b = image.at_or_background(i + (axis == 0), j + (axis == 1), k + (axis == 2));
          Vec3 centre{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          centre[axis] += 0.5;
          if (a != b) faces[{std::min(a, b), std::max(a, b)}].push_back(centre);
        }
      }
    }
  }
  return faces;
}

Vec3 in_voxels(const TissueImage& image, Vec3 p_mm) {
  const Vec3 d = p_mm - image.centre_mm(0, 0, 0);
  return {d.x / image.spacing_mm.x, d.y / image.spacing_mm.y, d.z / image.spacing_mm.z};
}

double distance_to(Vec3 p, const std::vector<Vec3>& points) {
  double nearest = 1e30;
  for (const Vec3 q : points) nearest = std::min(nearest, norm_squared(p - q));
  return std::sqrt(nearest);
}

TEST(EdgePoints, AreNearTheFacesOfTheirPairAndEveryFaceHasOneNear) {
  for (const testing::NamedImage& test : testing::all_test_images()) {
    SCOPED_TRACE(test.name);
    const TissueImage image = make_tissue_image(test.image);
    const auto faces = faces_by_pair(image);
    std::map<TissuePair, std::vector<Vec3>> points;
    for (const EdgePoint& p : find_edge_points(image)) points[p.pair].push_back(in_voxels(image, p.position_mm));
    ASSERT_EQ(points.size(), faces.size());
    for (const auto& [pair, centres] : faces) {
      ASSERT_TRUE(points.contains(pair));
      for (const Vec3 p : points[pair]) EXPECT_LE(distance_to(p, centres), 1.25 + 1e-9);
      // The point of a face may have given way to another one in the same voxel.
      for (const Vec3 c : centres) EXPECT_LE(distance_to(c, points[pair]), 1.25 + std::sqrt(3.0));
    }
  }
}

TEST(EdgePoints, AreOrderedAndOneAVoxelAndPair) {
  for (const testing::NamedImage& test : testing::all_test_images()) {
    SCOPED_TRACE(test.name);
    const TissueImage image = make_tissue_image(test.image);
    const std::vector<EdgePoint> points = find_edge_points(image);
    const auto key = [&](const EdgePoint& p) {
      return std::pair(image.offset(p.voxel[0], p.voxel[1], p.voxel[2]), p.pair);
    };
    for (std::size_t n = 0; n < points.size(); ++n) {
      EXPECT_LT(points[n].pair.low, points[n].pair.high);
      const Vec3 p = in_voxels(image, points[n].position_mm);
      for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::abs(p[a] - points[n].voxel[a]), 0.5 + 1e-9);
      if (n > 0) {
        EXPECT_LT(key(points[n - 1]), key(points[n]));
      }
    }
  }
}

TEST(EdgePoints, DoNotDependOnTheNumberOfThreads) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::random_blobs(3)));
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return find_edge_points(image);
  };
  const std::vector<EdgePoint> one = with_threads(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, with_threads(2));
  EXPECT_EQ(one, with_threads(7));
}

TEST(EdgePoints, LieOnASphereToASubVoxel) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.7, 1.1, 0.9}}) {
    const double voxel = std::cbrt(spacing.x * spacing.y * spacing.z);
    const Vec3 centre = {20.3 * spacing.x, 19.6 * spacing.y, 20.1 * spacing.z};
    const double radius = 12.4 * voxel;
    const TissueImage image =
        testing::tissues_of(41, spacing, [&](Vec3 p) { return static_cast<Label>(norm(p - centre) < radius ? 1 : 0); });
    const std::vector<EdgePoint> points = find_edge_points(image);
    double error = 0, bias = 0;
    for (const EdgePoint& p : points) {
      const double off = norm(p.position_mm - centre) - radius;
      error += std::abs(off);
      bias += off;
    }
    const double count = static_cast<double>(points.size());
    EXPECT_GT(count, 1200);
    EXPECT_LT(error / count, 0.15 * voxel);
    EXPECT_LT(std::abs(bias) / count, 0.06 * voxel);
  }
}

TEST(EdgePoints, LieOnAPlaneToASubVoxel) {
  const Vec3 on_plane = {16.3, 15.9, 16.2};
  for (const Vec3 direction : {Vec3{1, 2, 3}, Vec3{3, -1, 0.5}, Vec3{-2, 0.1, 1}}) {
    const Vec3 normal = (1 / norm(direction)) * direction;
    const TissueImage image = testing::tissues_of(
        33, {1, 1, 1}, [&](Vec3 p) { return static_cast<Label>(dot(p - on_plane, normal) < 0 ? 1 : 2); });
    double error = 0;
    int count = 0;
    for (const EdgePoint& p : find_edge_points(image)) {
      if (p.pair != TissuePair{1, 2}) continue;  // the rest is the outside of the image
      const auto away_from_border = [](double x) { return x > 3 && x < 29; };
      if (!away_from_border(p.position_mm.x) || !away_from_border(p.position_mm.y) ||
          !away_from_border(p.position_mm.z))
        continue;
      error += std::abs(dot(p.position_mm - on_plane, normal));
      ++count;
    }
    EXPECT_GT(count, 500);
    EXPECT_LT(error / count, 0.15);
  }
}

TEST(EdgePoints, FlatFacesAndThinSheetsKeepTheirPlace) {
  for (const int thickness : {1, 2, 7}) {
    const TissueImage image = testing::tissues_of(
        20, {0.8, 1, 2.5}, [&](Vec3 p) { return static_cast<Label>(p.z > 12 && p.z < 12 + 2.5 * thickness ? 1 : 0); });
    for (const EdgePoint& p : find_edge_points(image)) {
      if (p.voxel[0] < 7 || p.voxel[0] > 20 || p.voxel[1] < 7 || p.voxel[1] > 20) continue;
      const double below = 11.25, above = 11.25 + 2.5 * thickness;
      EXPECT_LT(std::min(std::abs(p.position_mm.z - below), std::abs(p.position_mm.z - above)), 0.04 * 2.5);
    }
  }
}

TEST(EdgePoints, CanBeCancelled) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(find_edge_points(make_tissue_image(testing::sphere()), source.get_token()), Cancelled);
}

}  // namespace
}  // namespace anatomesh
