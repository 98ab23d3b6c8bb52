// Fidelity of the final mesh, budgets of elements, islands and surfaces as the options ask for them.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "anatomesh/assess.h"
#include "anatomesh/errors.h"
#include "pipeline/guarantees.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

double mean_fidelity(const Result& result) {
  double sum = 0;
  for (const TissueOutcome& tissue : result.tissues) sum += std::min(tissue.f1, tissue.f2);
  return sum / static_cast<double>(result.tissues.size());
}

TEST(FinalFidelity, IsThatAskedForAndMeasuredWhereTheImageIsSmooth) {
  for (const double fidelity : {0.8, 0.9, 0.95}) {
    for (const LabelImage& image :
         {testing::sphere(), testing::nested_spheres(), testing::three_label_junction(), testing::torus()}) {
      Options options;
      options.lattice.fidelity = fidelity;
      const Result result = image_to_mesh(image, options);
      testing::expect_faithful(result);
      testing::expect_fidelity_as_measured(image, result);
    }
  }
}

TEST(FinalFidelity, TakesFewerElementsThanThatOfTheLattice) {
  const LabelImage image = testing::nested_spheres();
  Options options;
  const std::size_t final = image_to_mesh(image, options).mesh.tets.size();
  options.lattice.fidelity_stage = FidelityStage::lattice;
  options.lattice.min_size_mm = 1;
  EXPECT_LT(final, image_to_mesh(image, options).mesh.tets.size());
}

TEST(FinalFidelity, OnTheLatticeIsThatOfTheLattice) {
  Options options;
  options.lattice.fidelity_stage = FidelityStage::lattice;
  options.lattice.fidelity = 0.9;
  options.lattice.min_size_mm = 1;
  for (const TissueOutcome& tissue : image_to_mesh(testing::nested_spheres(), options).tissues) {
    EXPECT_GE(tissue.lattice_f1, tissue.fidelity) << tissue.label;
    EXPECT_GE(tissue.lattice_f2, tissue.fidelity) << tissue.label;
  }
}

/// The mesh of at most so many tetrahedra, checked; nothing where there is none.
std::optional<double> fidelity_within(const LabelImage& image, std::uint64_t max_elements) {
  Options options;
  options.lattice.fidelity = 0.99;
  options.lattice.max_elements = max_elements;
  try {
    const Result result = image_to_mesh(image, options);
    EXPECT_LE(result.mesh.tets.size(), max_elements);
    testing::expect_valid(image, result);
    testing::expect_bounded(result);
    testing::expect_complete(image, result);
    testing::expect_manifold(result);
    return mean_fidelity(result);
  } catch (const MeshingFailed&) {
    return std::nullopt;
  }
}

TEST(MaxElements, MoreThanTheImageTakesAreNotUsed) {
  Options options;
  options.lattice.fidelity = 1;
  options.lattice.max_elements = 100'000'000;
  const LabelImage image = testing::sphere(4);
  const Result result = image_to_mesh(image, options);
  testing::expect_valid(image, result);
  testing::expect_complete(image, result);
  EXPECT_LT(result.mesh.tets.size(), 1'000'000u);
  EXPECT_GT(mean_fidelity(result), 0.9);
}

TEST(MaxElements, AreNeverExceededAndMoreAreNoWorse) {
  constexpr double kLittle = 0.01;
  for (const LabelImage& image : {testing::nested_spheres(), testing::vessel_tree(), testing::random_blobs(5)}) {
    std::optional<double> last;
    for (const std::uint64_t most : {50u, 2000u, 8000u, 32000u}) {
      const std::optional<double> reached = fidelity_within(image, most);
      if (last) {
        ASSERT_TRUE(reached) << "no mesh of " << most << " though of fewer";
        EXPECT_GE(*reached, *last - kLittle) << most;
      }
      last = reached;
    }
    EXPECT_TRUE(last) << "no mesh of 32000 tetrahedra";
  }
}

TEST(FinalFidelity, WhatFallsShortIsSaid) {
  const LabelImage image = testing::nested_spheres();
  for (const double min_size_mm : {1.0, 8.0}) {
    Options options;
    options.lattice.bcc_size_mm = 8;
    options.lattice.min_size_mm = min_size_mm;
    const Result result = image_to_mesh(image, options);
    const bool lacks =
        std::ranges::any_of(result.tissues, [](const TissueOutcome& t) { return std::min(t.f1, t.f2) < t.fidelity; });
    const bool said = std::ranges::any_of(result.warnings, [](const std::string& warning) {
      return warning.find("below the fidelity asked for") != std::string::npos;
    });
    EXPECT_EQ(lacks, min_size_mm == 8);
    EXPECT_EQ(said, lacks);
  }
}

TEST(DropIslands, RemovesAndNamesThem) {
  LabelImage image = testing::sphere();
  for (const std::size_t x : {1u, 2u}) image.voxels[x + image.size[0] * (1 + image.size[1])] = 1;
  image.voxels[image.voxels.size() - 3] = 7;  // the largest part of a tissue is no island
  Options options;
  options.lattice.drop_islands = 3;
  const Result result = image_to_mesh(image, options);
  testing::expect_valid(image, result);
  EXPECT_EQ(assess(result.mesh).whole.topology.tet_components, 2u);
  EXPECT_TRUE(std::ranges::any_of(result.warnings, [](const std::string& warning) {
    return warning.find("1 island of label 1 (2 voxels) dropped") != std::string::npos;
  }));
}

TEST(DropIslands, KeepsAllWithoutIt) {
  LabelImage image = testing::sphere();
  image.voxels[image.voxels.size() - 3] = 7;
  EXPECT_EQ(image_to_mesh(image).tissues.size(), 2u);
}

TEST(AllowNonManifold, KeepsTheOtherGuarantees) {
  Options options;
  options.lattice.allow_non_manifold = true;
  for (const LabelImage& image : {testing::checkerboard(), testing::four_label_point()}) {
    const Result result = image_to_mesh(image, options);
    testing::expect_valid(image, result);
    testing::expect_bounded(result);
    testing::expect_complete(image, result);
    testing::expect_in_place(image, result);
  }
}

}  // namespace
}  // namespace anatomesh
