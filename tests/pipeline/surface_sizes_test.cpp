#include "pipeline/surface_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/test_images.h"

namespace anatomesh {
namespace {

constexpr SurfaceSizes::Range kRange = {8, 16, 0.5};

double size_of(const SurfaceSizes::Choice& choice, std::size_t tissue) {
  return std::ldexp(choice.root_mm, -choice.surface_level[tissue]);
}

Fidelity fidelity_of(double f) { return {1000000, static_cast<std::uint64_t>(f * 1e6), 1000000}; }

struct OneTissue {
  explicit OneTissue(double wanted, SurfaceSizes::Range range = kRange)
      : image(make_tissue_image(testing::sphere(12))), sizes(image, range, std::vector<double>{0, wanted}) {}
  TissueImage image;
  SurfaceSizes sizes;
  double size() const { return size_of(sizes.choose(), 1); }
};

TEST(SurfaceSizes, MoreFidelityTakesFinerSurfaces) {
  double last = 1e9;
  for (const double wanted : {0.8, 0.9, 0.95, 0.98, 0.99}) {
    const double size = OneTissue(wanted).size();
    EXPECT_LT(size, last) << wanted;
    last = size;
  }
}

TEST(SurfaceSizes, AreWithinTheRange) {
  for (const double wanted : {0.01, 0.5, 0.95, 1.0}) {
    const SurfaceSizes::Choice choice = OneTissue(wanted).sizes.choose();
    EXPECT_GT(choice.root_mm, kRange.smallest_root_mm);
    EXPECT_LE(choice.root_mm, kRange.largest_root_mm);
    EXPECT_GE(size_of(choice, 1), kRange.smallest_mm);
    EXPECT_LE(choice.surface_level[1], choice.levels);
  }
}

TEST(SurfaceSizes, AGivenRootIsKept) { EXPECT_EQ(OneTissue(0.95, {7, 7, 0.5}).sizes.choose().root_mm, 7); }

TEST(SurfaceSizes, SmallTissuesGetFinerSurfaces) {
  const TissueImage image = make_tissue_image(testing::nested_spheres());
  const SurfaceSizes sizes(image, kRange, std::vector<double>(image.labels.size(), 0.9));
  const SurfaceSizes::Choice choice = sizes.choose();
  const auto smallest = std::ranges::min_element(image.counts.begin() + 1, image.counts.end()) - image.counts.begin();
  EXPECT_EQ(choice.surface_level[static_cast<std::size_t>(smallest)], std::ranges::max(choice.surface_level));
}

TEST(SurfaceSizes, WhatFallsShortGetsFiner) {
  OneTissue c(0.95);
  const SurfaceSizes::Choice first = c.sizes.choose();
  EXPECT_TRUE(c.sizes.correct(first, std::vector<Fidelity>{{}, fidelity_of(0.9)}));
  EXPECT_LT(c.size(), size_of(first, 1));
}

TEST(SurfaceSizes, NothingIsBuiltAnewForALittle) {
  for (const double reached : {0.946, 0.95, 0.96}) {
    OneTissue c(0.95);
    EXPECT_FALSE(c.sizes.correct(c.sizes.choose(), std::vector<Fidelity>{{}, fidelity_of(reached)})) << reached;
  }
}

TEST(SurfaceSizes, ManyTetrahedraMayBeSaved) {
  OneTissue c(0.95);
  const SurfaceSizes::Choice first = c.sizes.choose();
  EXPECT_TRUE(c.sizes.correct(first, std::vector<Fidelity>{{}, fidelity_of(0.999)}));
  EXPECT_GT(c.size(), size_of(first, 1));
}

TEST(SurfaceSizes, WhatHasNotHelpedIsNotTriedAgain) {
  OneTissue c(0.95);
  EXPECT_TRUE(c.sizes.correct(c.sizes.choose(), std::vector<Fidelity>{{}, fidelity_of(0.7)}));
  EXPECT_FALSE(c.sizes.correct(c.sizes.choose(), std::vector<Fidelity>{{}, fidelity_of(0.71)}));
}

TEST(SurfaceSizes, ABudgetMakesThemLarger) {
  double last = 0;
  for (const double tets : {1.5e4, 5e3, 1.5e3}) {
    OneTissue c(1);
    c.sizes.fit_budget(tets);
    EXPECT_GT(c.size(), last) << tets;
    last = c.size();
  }
  OneTissue coarse(0.8);
  const double enough = coarse.size();
  coarse.sizes.fit_budget(1e7);
  EXPECT_EQ(coarse.size(), enough) << "what the fidelity takes is not made finer";
}

TEST(SurfaceSizes, Scale) {
  OneTissue c(0.98, {1, 16, 0.01});
  const double before = c.size();
  c.sizes.scale(0.5);
  EXPECT_NEAR(c.size() / before, 0.5, 0.08);
}

}  // namespace
}  // namespace anatomesh
