#include "lattice/bcc_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "base/vec.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

using testing::Corners;

LatticePoint sum(const LatticePoint& a, const LatticePoint& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
LatticePoint times(int s, const LatticePoint& a) { return {s * a[0], s * a[1], s * a[2]}; }
Vec3 real(const LatticePoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

Corners corners_of(const LatticePoint& barycentre) {
  const auto v = bcc_vertices(barycentre);
  return {real(v[0]), real(v[1]), real(v[2]), real(v[3])};
}

double volume_of(const LatticePoint& barycentre) { return std::abs(testing::shape_of(corners_of(barycentre)).volume); }

/// All integer points of [low, high)^3.
std::vector<LatticePoint> points_between(std::int32_t low, std::int32_t high) {
  std::vector<LatticePoint> points;
  for (std::int32_t z = low; z < high; ++z) {
    for (std::int32_t y = low; y < high; ++y) {
      for (std::int32_t x = low; x < high; ++x) points.push_back({x, y, z});
    }
  }
  return points;
}

std::vector<LatticePoint> barycentres_between(std::int32_t low, std::int32_t high) {
  std::vector<LatticePoint> points = points_between(low, high);
  std::erase_if(points, [](const LatticePoint& p) { return !is_bcc_barycentre(p); });
  return points;
}

std::vector<Vec3> random_points(int count, double low, double high) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> real_number(low, high);
  std::vector<Vec3> points(static_cast<std::size_t>(count));
  for (Vec3& p : points) p = {real_number(random), real_number(random), real_number(random)};
  return points;
}

/// Points on lattice planes, edges and vertices of this level and the next: where ties have to be broken.
std::vector<Vec3> points_on_planes(std::int32_t low, std::int32_t high) {
  std::vector<Vec3> points;
  for (const LatticePoint& p : points_between(2 * low, 2 * high)) points.push_back(0.5 * real(p));
  return points;
}

TEST(BccLattice, TwelveTetsStartInEachCube) {
  std::map<LatticePoint, std::set<int>> local;
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const int index = bcc_local_index(b);
    EXPECT_EQ(bcc_from_local(bcc_cell(b), index), b);
    EXPECT_TRUE(local[bcc_cell(b)].insert(index).second);
  }
  EXPECT_EQ(local.size(), 64u);
  for (const auto& [cell, indices] : local) {
    EXPECT_EQ(indices.size(), static_cast<std::size_t>(kTetsPerCell));
    EXPECT_EQ(*indices.begin(), 0);
    EXPECT_EQ(*indices.rbegin(), kTetsPerCell - 1);
  }
}

TEST(BccLattice, VerticesAreCubeCornersAndCubeCentres) {
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const auto v = bcc_vertices(b);
    for (std::size_t n = 0; n < 4; ++n) {
      for (const std::int32_t c : v[n]) EXPECT_EQ(c & 3, n < 2 ? 0 : 2);
    }
    EXPECT_EQ(sum(sum(v[0], v[1]), sum(v[2], v[3])), times(4, b));
  }
}

TEST(BccLattice, TetsHaveTwoLongAndFourShortEdges) {
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const auto v = corners_of(b);
    for (std::size_t e = 0; e < 6; ++e) {
      const Vec3 edge = v[static_cast<std::size_t>(kTetEdges[e][1])] - v[static_cast<std::size_t>(kTetEdges[e][0])];
      EXPECT_EQ(norm_squared(edge), e < 2 ? 16 : 12);
    }
  }
}

TEST(BccLattice, SignOfTheVolumeIsKnown) {
  for (const LatticePoint& b : barycentres_between(-8, 8))
    EXPECT_EQ(testing::shape_of(corners_of(b)).volume > 0, is_positive(b));
}

TEST(BccLattice, ChildrenTileTheParent) {
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const auto v = bcc_vertices(b);
    std::set<LatticePoint> allowed;  // in units of the children
    for (const LatticePoint& p : v) allowed.insert(times(2, p));
    for (int e = 0; e < 6; ++e) allowed.insert(times(2, bcc_edge_midpoint(b, e)));
    double volume = 0;
    std::set<LatticePoint> children;
    for (const LatticePoint& child : bcc_children(b)) {
      EXPECT_TRUE(is_bcc_barycentre(child));
      EXPECT_TRUE(children.insert(child).second);
      for (const LatticePoint& p : bcc_vertices(child)) EXPECT_TRUE(allowed.contains(p));
      volume += volume_of(child);
    }
    EXPECT_DOUBLE_EQ(volume, 8 * volume_of(b));
  }
}

TEST(BccLattice, FirstFourChildrenLieAtTheVertices) {
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const auto v = bcc_vertices(b);
    const auto children = bcc_children(b);
    for (std::size_t n = 0; n < 4; ++n) {
      const auto corners = bcc_vertices(children[n]);
      EXPECT_NE(std::find(corners.begin(), corners.end(), times(2, v[n])), corners.end());
    }
  }
}

TEST(BccLattice, ParentOfAChildIsTheParent) {
  for (const LatticePoint& b : barycentres_between(-12, 12)) {
    for (const LatticePoint& child : bcc_children(b)) EXPECT_EQ(bcc_parent(child), b);
  }
}

TEST(BccLattice, EveryTetIsAChildOfItsParent) {
  for (const LatticePoint& b : barycentres_between(-12, 12)) {
    const auto siblings = bcc_children(bcc_parent(b));
    EXPECT_NE(std::find(siblings.begin(), siblings.end(), b), siblings.end());
  }
}

TEST(BccLattice, EdgesAreKnownByTheirMidpoints) {
  for (const LatticePoint& b : barycentres_between(-8, 8)) {
    const auto v = bcc_vertices(b);
    for (int e = 0; e < 6; ++e) {
      const auto& ends = kTetEdges[static_cast<std::size_t>(e)];
      const LatticePoint middle = bcc_edge_midpoint(b, e);
      EXPECT_EQ(times(2, middle), sum(v[static_cast<std::size_t>(ends[0])], v[static_cast<std::size_t>(ends[1])]));
      EXPECT_EQ(bcc_edge_at(b, middle), e);
    }
  }
}

TEST(BccLattice, RingsHoldAllTetsOfAnEdge) {
  std::map<LatticePoint, std::set<LatticePoint>> around;  // by edge midpoint
  for (const LatticePoint& b : barycentres_between(-12, 12)) {
    for (int e = 0; e < 6; ++e) around[bcc_edge_midpoint(b, e)].insert(b);
  }
  for (const LatticePoint& b : barycentres_between(-4, 4)) {
    for (int e = 0; e < 6; ++e) {
      const LatticePoint middle = bcc_edge_midpoint(b, e);
      const BccRing ring = bcc_tets_around(middle);
      const std::set<LatticePoint> found(ring.barycentre.begin(), ring.barycentre.begin() + ring.count);
      EXPECT_EQ(ring.count, e < 2 ? 4 : 6);
      EXPECT_EQ(found, around[middle]);
    }
  }
}

TEST(BccLattice, LocateAgreesWithContainment) {
  const auto tets = barycentres_between(-8, 8);
  for (const Vec3 p : random_points(500, -4, 4)) {
    std::set<LatticePoint> holders;
    for (const LatticePoint& b : tets) {
      if (testing::depth_inside(corners_of(b), p) > 0) holders.insert(b);
    }
    EXPECT_EQ(holders, std::set<LatticePoint>{bcc_locate(p)});
  }
}

TEST(BccLattice, PointsOnFacesAreLocatedInATetThatTouchesThem) {
  for (const Vec3 p : points_on_planes(-8, 8)) {
    const LatticePoint b = bcc_locate(p);
    ASSERT_TRUE(is_bcc_barycentre(b));
    EXPECT_GE(testing::depth_inside(corners_of(b), p), -1e-12);
  }
}

TEST(BccLattice, ChildAtAgreesWithContainment) {
  std::vector<Vec3> points = random_points(2000, -8, 8);
  const std::vector<Vec3> on_planes = points_on_planes(-8, 8);
  points.insert(points.end(), on_planes.begin(), on_planes.end());
  for (const Vec3 p : points) {
    const LatticePoint b = bcc_locate(p);
    const auto children = bcc_children(b);
    const int chosen = bcc_child_at(b, p);
    for (int c = 0; c < 8; ++c) {
      const double depth = testing::depth_inside(corners_of(children[static_cast<std::size_t>(c)]), 2 * p);
      if (depth > 1e-12) {
        EXPECT_EQ(chosen, c);
      }
      if (chosen == c) {
        EXPECT_GE(depth, -1e-12);
      }
    }
  }
}

TEST(BccLattice, BarycentricCoordinatesAgreeWithVolumes) {
  for (const Vec3 p : random_points(500, -8, 8)) {
    const LatticePoint b = bcc_locate(p);
    const auto fast = bcc_barycentric_times_4(b, p);
    const auto slow = testing::barycentric_of(corners_of(b), p);
    for (std::size_t n = 0; n < 4; ++n) EXPECT_NEAR(fast[n], 4 * slow[n], 1e-12);
  }
}

}  // namespace
}  // namespace anatomesh
