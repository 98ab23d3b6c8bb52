#include <gtest/gtest.h>

#include <cmath>

#include "anatomesh/assess.h"
#include "base/vec.h"
#include "support/test_images.h"
#include "voxel_mesh.h"

namespace anatomesh {
namespace {

using testing::make_image;
using testing::mesh_of_voxels;
using testing::VoxelCut;

void expect_perfect(const TissueAssessment& t) {
  EXPECT_EQ(t.fidelity.f1, 1);
  EXPECT_EQ(t.fidelity.f2, 1);
  EXPECT_EQ(t.fidelity.dice, 1);
  EXPECT_EQ(t.fidelity.mesh_voxels, t.fidelity.image_voxels);
  EXPECT_NEAR(t.fidelity.volume_error_percent, 0, 1e-9);
  EXPECT_NEAR(t.fidelity.distance.mean_mm, 0, 1e-6);
  EXPECT_NEAR(t.fidelity.distance.p95_mm, 0, 1e-6);
  EXPECT_NEAR(t.fidelity.distance.max_mm, 0, 1e-5);
  EXPECT_EQ(t.topology.volume_euler, t.topology.image_euler);
  EXPECT_EQ(t.topology.tet_components, t.topology.image_components_6);
}

TEST(Fidelity, TheVoxelsThemselvesArePerfectInEveryFrame) {
  for (const auto& [name, image] : testing::all_test_images()) {
    SCOPED_TRACE(name);
    const TetMesh mesh = mesh_of_voxels(image);
    if (mesh.tets.size() > 30000) continue;
    const Assessment a = assess(mesh, &image);
    expect_perfect(a.whole);
    for (const auto& t : a.tissues) expect_perfect(t);
    EXPECT_EQ(a.summary.voxels_right, 1);
    EXPECT_EQ(a.summary.euler_mismatches, 0u);
  }
}

TEST(Fidelity, EveryCutOfAVoxelIsPerfect) {
  const LabelImage image = testing::oblique(testing::two_touching_cubes());
  for (const VoxelCut cut : {VoxelCut::five, VoxelCut::six, VoxelCut::twelve}) {
    const Assessment a = assess(mesh_of_voxels(image, cut), &image);
    for (const auto& t : a.tissues) expect_perfect(t);
  }
}

TEST(Fidelity, RasFrameTurnsTheFirstTwoAxes) {
  const LabelImage image = testing::left_handed(testing::oblique(testing::three_label_junction()));
  const TetMesh ras = testing::moved(mesh_of_voxels(image), [](Vec3 p) { return Vec3{-p.x, -p.y, p.z}; });
  AssessOptions options;
  options.frame = Frame::ras;
  const Assessment a = assess(ras, &image, options);
  expect_perfect(a.whole);
  EXPECT_FALSE(a.conformity.negative_orientation);
  EXPECT_LT(assess(ras, &image).whole.fidelity.dice, 0.5);  // taken as LPS it lies elsewhere
}

TEST(Fidelity, BlockMovedByOneVoxel) {
  const LabelImage image = make_image(
      {14, 8, 8}, [](int i, int j, int k) { return Label{i >= 2 && i < 10 && j >= 2 && j < 6 && k >= 2 && k < 6}; });
  const TetMesh mesh = testing::moved(mesh_of_voxels(image), [](Vec3 p) { return Vec3{p.x + 1, p.y, p.z}; });
  const Fidelity f = assess(mesh, &image).whole.fidelity;
  EXPECT_EQ(f.common_voxels, 7u * 4 * 4);
  EXPECT_DOUBLE_EQ(f.f1, 7.0 / 8);
  EXPECT_DOUBLE_EQ(f.f2, 7.0 / 8);
  EXPECT_DOUBLE_EQ(f.dice, 7.0 / 8);
  EXPECT_NEAR(f.volume_error_percent, 0, 1e-9);
  EXPECT_NEAR(f.distance.max_mm, 1, 1e-6);
  EXPECT_NEAR(f.distance.p95_mm, 1, 1e-6);
  // Of 160 mm2, one end (16) is 1 mm away all over; the last mm of the sides (16) from 0 to 1 mm; the other end (16) is
  // 1 mm away but nearer than that to the sides along its rim: a truncated pyramid of 28 / 3 mm3.
  const double mean = (16 + 16 * 0.5 + 28.0 / 3) / 160;
  EXPECT_NEAR(f.distance.mesh_to_image.mean_mm, mean, 0.002);
  EXPECT_NEAR(f.distance.image_to_mesh.mean_mm, mean, 0.002);
}

TEST(Fidelity, ConcentricBlocksAreTheirGapApart) {
  const LabelImage image = make_image({20, 20, 20}, [](int i, int j, int k) {
    return Label{i >= 4 && i < 16 && j >= 4 && j < 16 && k >= 4 && k < 16};
  });
  const Vec3 middle = {9.5, 9.5, 9.5};
  const TetMesh mesh = testing::moved(mesh_of_voxels(image), [&](Vec3 p) { return middle + 5.0 / 6 * (p - middle); });
  const Fidelity f = assess(mesh, &image).whole.fidelity;
  EXPECT_NEAR(f.volume_error_percent, 100 * (125.0 / 216 - 1), 1e-9);
  EXPECT_NEAR(f.distance.mesh_to_image.mean_mm, 1, 1e-6);
  EXPECT_NEAR(f.distance.mesh_to_image.max_mm, 1, 1e-6);
  EXPECT_GT(f.distance.image_to_mesh.max_mm, 1.4);  // edges and corners of the outer one are farther
  EXPECT_LT(f.distance.image_to_mesh.max_mm, std::sqrt(3));
}

TEST(Fidelity, MissingTissueAndExtraLabel) {
  const LabelImage image = make_image({12, 6, 6}, [](int i, int j, int k) {
    if (i == 10 && j == 3 && k == 3) return Label{4000000000};
    return Label{i >= 1 && i < 7 && j >= 1 && j < 5 && k >= 1 && k < 5 ? 2u : 0u};
  });
  TetMesh mesh = mesh_of_voxels(image);
  for (Label& l : mesh.labels) {
    if (l == 4000000000) l = 9;
  }
  const Assessment a = assess(mesh, &image);
  ASSERT_EQ(a.tissues.size(), 3u);
  const TissueAssessment& extra = a.tissues[1];
  EXPECT_EQ(extra.label, 9u);
  EXPECT_TRUE(extra.in_mesh);
  EXPECT_FALSE(extra.in_image);
  EXPECT_EQ(extra.fidelity.dice, 0);
  EXPECT_TRUE(std::isnan(extra.fidelity.volume_error_percent));
  EXPECT_TRUE(std::isnan(extra.fidelity.distance.mean_mm));
  const TissueAssessment& missing = a.tissues[2];
  EXPECT_EQ(missing.label, 4000000000);
  EXPECT_FALSE(missing.in_mesh);
  EXPECT_EQ(missing.quality.tets, 0u);
  EXPECT_EQ(missing.fidelity.image_voxels, 1u);
  EXPECT_EQ(missing.fidelity.f1, 0);
  EXPECT_EQ(missing.fidelity.f2, 0);
  EXPECT_EQ(missing.fidelity.dice, 0);
  EXPECT_TRUE(std::isnan(missing.fidelity.distance.mean_mm));
  EXPECT_EQ(missing.topology.image_components_6, 1u);
  EXPECT_EQ(a.summary.missing_labels, std::vector<Label>{4000000000});
  EXPECT_EQ(a.summary.extra_labels, std::vector<Label>{9});
  EXPECT_EQ(a.summary.min_dice, 0);
  EXPECT_DOUBLE_EQ(a.summary.voxels_right, 96.0 / 97);
}

TEST(Fidelity, CentresOnFacesBelongToOneTetrahedron) {
  // Voxel centres lie on vertices, edges and faces of a mesh moved by half a voxel.
  const LabelImage image = testing::three_label_junction();
  const TetMesh mesh = testing::moved(mesh_of_voxels(image), [](Vec3 p) {
    return Vec3{p.x + 0.5, p.y + 0.5, p.z + 0.5};
  });
  const Assessment a = assess(mesh, &image);
  std::uint64_t voxels = 0;
  for (const auto& t : a.tissues) voxels += t.fidelity.mesh_voxels;
  EXPECT_EQ(voxels, a.whole.fidelity.mesh_voxels);
  EXPECT_EQ(a.conformity.voxel_centres_in_several_tets, 0u);
}

TEST(Fidelity, MeshOutsideTheImage) {
  const LabelImage image = testing::sphere(4);
  const TetMesh mesh = testing::moved(mesh_of_voxels(image), [](Vec3 p) { return Vec3{p.x + 1000, p.y, p.z}; });
  const Assessment a = assess(mesh, &image);
  EXPECT_EQ(a.whole.fidelity.mesh_voxels, 0u);
  EXPECT_EQ(a.whole.fidelity.dice, 0);
  EXPECT_NEAR(a.whole.fidelity.distance.mean_mm, 1000, 10);
}

}  // namespace
}  // namespace anatomesh
