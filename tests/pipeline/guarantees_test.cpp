// The guarantees of docs/design.md on every generated image, with default options and others.
#include "pipeline/guarantees.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "anatomesh/assess.h"
#include "anatomesh/quadratic.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

using testing::NamedImage;

const std::vector<NamedImage>& images() {
  static const std::vector<NamedImage> images = testing::all_test_images();
  return images;
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& info) { return images()[info.param].name; }

class Guarantees : public ::testing::TestWithParam<std::size_t> {
 protected:
  const LabelImage& image() const { return images()[GetParam()].image; }
};

INSTANTIATE_TEST_SUITE_P(AllImages, Guarantees, ::testing::Range(std::size_t{0}, images().size()), name_of);

TEST_P(Guarantees, HoldWithDefaultOptions) { testing::expect_guarantees(image(), image_to_mesh(image())); }

TEST_P(Guarantees, HoldInRas) {
  Options options;
  options.frame = Frame::ras;
  options.deform.iterations = 1;
  testing::expect_guarantees(image(), image_to_mesh(image(), options));
}

TEST_P(Guarantees, HoldOnTheLattice) {
  Options options;
  options.deform.iterations = 0;
  testing::expect_guarantees(image(), image_to_mesh(image(), options));
}

TEST_P(Guarantees, HoldForQuadraticTetrahedra) {
  Options options;
  options.order = 2;
  options.deform.iterations = 2;
  const Result result = image_to_mesh(image(), options);
  const Assessment found = assess(result.mesh, &image(), {.distances = false});
  EXPECT_EQ(failed_guarantees(found), std::vector<std::string>());
  EXPECT_EQ(found.curves.tets, result.mesh.tets.size());
  EXPECT_GE(found.curves.min_jacobian, 0.3);
}

TEST(QuadraticTetrahedra, HaveTheCornersOfLinearOnes) {
  Options options;
  const LabelImage image = testing::nested_spheres();
  const TetMesh linear = image_to_mesh(image, options).mesh;
  options.order = 2;
  const TetMesh corners = linear_mesh(image_to_mesh(image, options).mesh);
  EXPECT_EQ(corners.points_mm, linear.points_mm);
  EXPECT_EQ(corners.tets, linear.tets);
}

std::vector<LabelImage> a_few_images() {
  return {testing::nested_spheres(), testing::vessel_tree(), testing::four_label_point(), testing::one_voxel(),
          testing::anisotropic(testing::random_blobs(5))};
}

void expect_guarantees_with(const Options& options) {
  for (const LabelImage& image : a_few_images()) testing::expect_guarantees(image, image_to_mesh(image, options));
}

/// For meshes too coarse to lie near their voxels.
void expect_all_but_in_place(const Options& options) {
  for (const LabelImage& image : a_few_images()) {
    const Result result = image_to_mesh(image, options);
    testing::expect_valid(image, result);
    testing::expect_bounded(result);
    testing::expect_complete(image, result);
  }
}

TEST(GuaranteesAtTheEnds, TightestBounds) {
  Options options;
  options.deform.min_dihedral_deg = 30;
  options.deform.max_dihedral_deg = 117;
  options.deform.min_mean_ratio = 0.5;
  expect_guarantees_with(options);
}

TEST(GuaranteesAtTheEnds, NoBounds) {
  Options options;
  options.deform.min_dihedral_deg = 0;
  options.deform.max_dihedral_deg = 180;
  options.deform.min_mean_ratio = 0;
  expect_guarantees_with(options);
}

TEST(GuaranteesAtTheEnds, FullFidelity) {
  Options options;
  options.lattice.fidelity = 1;
  options.lattice.bcc_size_mm = 16;
  options.lattice.min_size_mm = 1.5;
  options.deform.iterations = 2;
  expect_guarantees_with(options);
}

TEST(GuaranteesAtTheEnds, LeastFidelity) {
  Options options;
  options.lattice.fidelity = 1e-9;
  expect_all_but_in_place(options);
}

TEST(GuaranteesAtTheEnds, CoarserThanTheImage) {
  Options options;
  options.lattice.bcc_size_mm = 100;
  expect_all_but_in_place(options);
}

TEST(GuaranteesAtTheEnds, SoftAndStiffTissues) {
  Options options;
  options.deform.default_material = {1e-3, 0};
  options.deform.material[1] = {1e9, 0.4999};
  for (const LabelImage& image : {testing::vessel_tree(), testing::four_label_point()})
    testing::expect_guarantees(image, image_to_mesh(image, options));
}

// As written in a file of few digits.
TEST(GuaranteesAtTheEnds, DirectionsThatAreRotationsToFourDigits) {
  Options options;
  options.deform.min_dihedral_deg = 29;
  options.deform.max_dihedral_deg = 118;
  LabelImage image = testing::oblique(testing::vessel_tree());
  for (auto& row : image.direction) {
    for (double& entry : row) entry = std::round(entry * 2e4) / 2e4;
  }
  testing::expect_guarantees(image, image_to_mesh(image, options));
}

TEST(GuaranteesAtTheEnds, FarFromTheOrigin) {
  Options options;
  options.deform.min_dihedral_deg = 29;
  options.deform.max_dihedral_deg = 118;
  LabelImage image = testing::oblique(testing::anisotropic(testing::vessel_tree()));
  image.origin_mm = {6e7, -6e7, 1e8};
  const Result result = image_to_mesh(image, options);
  testing::expect_bounded(result);
  testing::expect_complete(image, result);
  testing::expect_in_place(image, result);
}

}  // namespace
}  // namespace anatomesh
