#include "mesh/star_slack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "base/vec.h"

namespace anatomesh {
namespace {

struct Face {
  Vec3 b, c, d;
  bool is_cushion;
};

class RandomStars {
 public:
  explicit RandomStars(unsigned seed) : random_(seed) {}
  Vec3 point(double size) { return {size * number_(random_), size * number_(random_), size * number_(random_)}; }
  // Faces around the origin that see it mostly from the right side.
  std::vector<Face> star(std::size_t tets) {
    std::vector<Face> faces;
    while (faces.size() < tets) {
      Face f{point(1), point(1), point(1), faces.size() % 5 == 4};
      if (six_volumes({}, f.b, f.c, f.d) < 0 && faces.size() % 7 != 6) std::swap(f.c, f.d);
      faces.push_back(f);
    }
    return faces;
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> number_{-1, 1};
};

double slack_of(const ShapeBounds& bounds, const Face& f, Vec3 p) {
  if (f.is_cushion) return within(kCushionBounds, p, f.b, f.c, f.d) ? 1 : -1;
  return slack(bounds, p, f.b, f.c, f.d);
}

TEST(StarSlack, IsTheLeastOfItsTetrahedra) {
  const ShapeBounds bounds = ShapeBounds::from_degrees(5, 170, 0.05);
  RandomStars random(1);
  StarSlack star;
  for (int n = 0; n < 3000; ++n) {
    const std::vector<Face> faces = random.star(1 + static_cast<std::size_t>(n) % 40);
    star.start(bounds, {});
    for (const Face& f : faces) star.add(f.b, f.c, f.d, f.is_cushion);
    star.close();
    const Vec3 p = random.point(0.2);
    double least = 1;
    for (const Face& f : faces) least = std::min(least, slack_of(bounds, f, p));
    EXPECT_NEAR(star.at(p, -2), least, 1e-9);
  }
}

TEST(StarSlack, StopsBelowWhatIsEnough) {
  const ShapeBounds bounds = ShapeBounds::from_degrees(5, 170, 0.05);
  RandomStars random(2);
  StarSlack star;
  for (int n = 0; n < 3000; ++n) {
    star.start(bounds, {});
    for (const Face& f : random.star(30)) star.add(f.b, f.c, f.d, f.is_cushion);
    star.close();
    const Vec3 p = random.point(0.2);
    const double least = star.at(p, -2), enough = n % 2 ? 0.1 : -0.5;
    const double there = star.at(p, enough);
    EXPECT_GE(there, least);
    EXPECT_TRUE(least >= enough ? there == least : there < enough);
    EXPECT_EQ(star.fits(p), least >= 0);
  }
}

TEST(StarSlack, AFlatTetrahedronIsOutside) {
  for (const double ratio : {0.01, 0.3}) {
    const ShapeBounds bounds = ShapeBounds::from_degrees(0, 180, ratio);
    StarSlack star;
    star.start(bounds, {});
    star.add({1, 0, 0}, {0, 1, 0}, {-1, -1, 0}, false);
    star.close();
    EXPECT_LT(star.at({0, 0, 0}, -2), 0);
    star.start(bounds, {});
    star.add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, true);  // without an area
    star.close();
    EXPECT_LT(star.at({0, 0, 1}, -2), 0);
  }
}

TEST(StarSlack, NoPlaceWhereATetrahedronDegeneratesIsInside) {
  const ShapeBounds bounds = ShapeBounds::from_degrees(20, 150, 0.3);
  RandomStars random(3);
  StarSlack star;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 b = random.point(1), c = random.point(1), d = random.point(1);
    star.start(bounds, {});
    star.add(b, c, d, false);
    star.close();
    EXPECT_LT(star.at(c, -2), 0);
    EXPECT_LT(star.at(0.5 * (c + d), -2), 0);
    star.add(b, d, c, false);  // of the other orientation: one of both is turned over anywhere
    star.close();
    EXPECT_LT(star.at(c, -2), 0);
    EXPECT_LT(star.at(random.point(1), -2), 0);
  }
}

TEST(StarSlack, WithoutTetrahedraAllPlacesAreGood) { EXPECT_EQ(StarSlack().at({1, 2, 3}, 0), 1); }

// In single precision: near the exact slack, and never above it. Far from the frame's origin, as real meshes are.
TEST(StarSlack, InSinglePrecisionErrsToTheSafeSide) {
  RandomStars random(4);
  StarSlack star;
  int inside = 0;
  for (int n = 0; n < 20000; ++n) {
    const ShapeBounds bounds = ShapeBounds::from_degrees(5 + n % 20, 160, StarSlack::kSingleRatio + 0.02 * (n % 3));
    const Vec3 far = {1000.0 * (n % 5), -300, 70};
    const std::vector<Face> faces = random.star(1 + static_cast<std::size_t>(n) % 3);
    star.start(bounds, far);
    for (const Face& f : faces) star.add(far + f.b, far + f.c, far + f.d, f.is_cushion);
    star.close();
    const Vec3 p = random.point(0.3);
    double least = 1;
    for (const Face& f : faces) least = std::min(least, slack_of(bounds, f, p));
    const double there = star.at(far + p, -2);
    if (least < -0.5) continue;
    EXPECT_LE(there, least);
    EXPECT_GE(there, least - 2 * StarSlack::kRounding);
    inside += least >= 0;
  }
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace anatomesh
