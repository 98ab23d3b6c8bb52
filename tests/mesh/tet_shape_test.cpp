#include "mesh/tet_shape.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

using testing::Corners;

ShapeMeasure measure(const Corners& c) { return measure_shape(c[0], c[1], c[2], c[3]); }
double degrees(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi; }

/// A tetrahedron whose shape is known.
struct KnownShape {
  const char* name;
  Corners corners;
  double min_dihedral_deg, max_dihedral_deg, mean_ratio;
};

const std::vector<KnownShape>& known_shapes() {
  static const std::vector<KnownShape> shapes = {
      {"regular", {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}}, 70.528779366, 70.528779366, 1},
      {"right corner", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 54.735610317, 90, 0.839947367},
      {"BCC", {{{0, -2, -1}, {0, 2, -1}, {-2, 0, 1}, {2, 0, 1}}}, 60, 90, 0.952440631}};
  return shapes;
}

/// The same tetrahedron with positive volume.
Corners positive(Corners corners) {
  if (six_volumes(corners[0], corners[1], corners[2], corners[3]) < 0) std::swap(corners[2], corners[3]);
  return corners;
}

TEST(TetShape, KnownTets) {
  for (const KnownShape& known : known_shapes()) {
    SCOPED_TRACE(known.name);
    const ShapeMeasure shape = measure(positive(known.corners));
    EXPECT_NEAR(degrees(shape.largest_cos), known.min_dihedral_deg, 1e-6);
    EXPECT_NEAR(degrees(shape.smallest_cos), known.max_dihedral_deg, 1e-6);
    EXPECT_NEAR(shape.mean_ratio, known.mean_ratio, 1e-6);
  }
}

TEST(TetShape, SliverHasAnglesNear0And180) {
  const ShapeMeasure shape = measure(positive({{{1, 0, 1e-4}, {-1, 0, 1e-4}, {0, 1, -1e-4}, {0, -1, -1e-4}}}));
  EXPECT_LT(degrees(shape.largest_cos), 0.1);
  EXPECT_GT(degrees(shape.smallest_cos), 179.9);
  EXPECT_LT(shape.mean_ratio, 0.01);
}

TEST(TetShape, NeedleHasABadMeanRatioThoughItsAnglesAreFine) {
  const ShapeMeasure shape = measure(positive({{{0, 0, 0}, {1, 0, 0}, {0.5, 0.9, 0}, {0.5, 0.3, 100}}}));
  EXPECT_GT(degrees(shape.largest_cos), 55);
  EXPECT_LT(degrees(shape.smallest_cos), 95);
  EXPECT_LT(shape.mean_ratio, 0.01);
}

TEST(TetShape, InvertedAndFlatOnesBreakAllBounds) {
  Corners inverted = positive(known_shapes()[0].corners);
  std::swap(inverted[0], inverted[1]);
  const Corners flat = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}};
  const Corners point = {};
  for (const Corners& c : {inverted, flat, point}) {
    const ShapeMeasure shape = measure(c);
    EXPECT_EQ(shape.mean_ratio, 0);
    EXPECT_EQ(shape.largest_cos, 1);
    EXPECT_EQ(shape.smallest_cos, -1);
    EXPECT_FALSE(ShapeBounds::from_degrees(0, 180, 0).hold(shape));
    EXPECT_FALSE(within(ShapeBounds::from_degrees(0, 180, 0), c[0], c[1], c[2], c[3]));
  }
}

Corners random_tet(std::mt19937& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  Corners corners;
  for (Vec3& p : corners) {
    p.x = coordinate(random);
    p.y = coordinate(random);
    p.z = coordinate(random) * (random() % 4 == 0 ? 0.05 : 1);
  }
  return corners;
}

TEST(TetShape, AgreesWithAnglesBetweenFaces) {
  std::mt19937 random(1);
  for (int n = 0; n < 5000; ++n) {
    const Corners corners = positive(random_tet(random));
    const ShapeMeasure shape = measure(corners);
    const auto slow = testing::shape_of(corners);
    if (slow.volume < 1e-6) continue;
    EXPECT_NEAR(degrees(shape.largest_cos), slow.min_dihedral_deg, 1e-4);
    EXPECT_NEAR(degrees(shape.smallest_cos), slow.max_dihedral_deg, 1e-4);
    EXPECT_NEAR(shape.mean_ratio, slow.mean_ratio, 1e-9);
  }
}

TEST(TetShape, DoesNotDependOnOrderPlaceOrSize) {
  std::mt19937 random(2);
  for (int n = 0; n < 500; ++n) {
    const Corners c = positive(random_tet(random));
    const ShapeMeasure shape = measure(c);
    const auto moved = [&](std::size_t v) { return 37.5 * c[v] + Vec3{100, -200, 50}; };
    const ShapeMeasure other = measure_shape(moved(1), moved(2), moved(0), moved(3));
    EXPECT_NEAR(shape.largest_cos, other.largest_cos, 1e-6);
    EXPECT_NEAR(shape.smallest_cos, other.smallest_cos, 1e-6);
    EXPECT_NEAR(shape.mean_ratio, other.mean_ratio, 1e-6);
  }
}

// Without a root or a division, so equal but for rounding at the very bound.
TEST(TetShape, WithinAgreesWithTheMeasure) {
  std::mt19937 random(3);
  int inside = 0;
  for (const auto& bounds : {ShapeBounds::from_degrees(15, 155, 0.3), ShapeBounds::from_degrees(30, 117, 0.5),
                             ShapeBounds::from_degrees(5, 170, 0.05), ShapeBounds::from_degrees(0, 180, 0)}) {
    for (int n = 0; n < 20000; ++n) {
      const Corners c = random_tet(random);
      const ShapeMeasure shape = measure(c);
      EXPECT_EQ(within(bounds, c[0], c[1], c[2], c[3]), bounds.hold(shape));
      inside += bounds.hold(shape);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(TetShape, SlackIsTheSmallestMargin) {
  std::mt19937 random(4);
  for (const auto& bounds : {ShapeBounds::from_degrees(15, 155, 0.3), ShapeBounds::from_degrees(0, 180, 0.6)}) {
    for (int n = 0; n < 20000; ++n) {
      const Corners c = random_tet(random);
      const ShapeMeasure shape = measure(c);
      const double bound = bounds.min_mean_ratio;
      const double of_ratio = (std::pow(shape.mean_ratio, 3) - std::pow(bound, 3)) / (3 * bound * bound);
      const double margin =
          shape.mean_ratio == 0
              ? -1
              : std::min({bounds.largest_cos - shape.largest_cos, shape.smallest_cos - bounds.smallest_cos, of_ratio});
      EXPECT_NEAR(slack(bounds, c[0], c[1], c[2], c[3]), margin, 1e-12);
    }
  }
}

TEST(ShapeBounds, HoldOnTheRightSide) {
  const ShapeBounds bounds = ShapeBounds::from_degrees(20, 150, 0.3);
  const auto shape = [](double low_deg, double high_deg, double mean_ratio) {
    constexpr double kRadians = std::numbers::pi / 180;
    return ShapeMeasure{std::cos(low_deg * kRadians), std::cos(high_deg * kRadians), mean_ratio};
  };
  EXPECT_TRUE(bounds.hold(shape(20.00001, 149.9999, 0.30001)));
  EXPECT_FALSE(bounds.hold(shape(19.9999, 149, 0.5)));
  EXPECT_FALSE(bounds.hold(shape(30, 150.0001, 0.5)));
  EXPECT_FALSE(bounds.hold(shape(30, 140, 0.29999)));
  EXPECT_FALSE(bounds.hold(shape(20, 150, 0.3))) << "there is a margin";
}

TEST(SixVolumes, OfTheUnitCorner) {
  EXPECT_EQ(six_volumes({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(six_volumes({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}), -1);
}

}  // namespace
}  // namespace anatomesh
