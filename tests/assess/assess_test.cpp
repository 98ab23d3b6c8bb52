#include "anatomesh/assess.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "support/test_images.h"
#include "voxel_mesh.h"

namespace anatomesh {
namespace {

using testing::mesh_of_voxels;

// The same bits, NaN included.
void expect_same(double a, double b) { EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0) << a << " and " << b; }

void expect_same(const TissueAssessment& a, const TissueAssessment& b) {
  expect_same(a.quality.volume_mm3, b.quality.volume_mm3);
  expect_same(a.quality.mean_edge_mm, b.quality.mean_edge_mm);
  expect_same(a.quality.mean_mean_ratio, b.quality.mean_mean_ratio);
  expect_same(a.quality.dihedral_p1_deg, b.quality.dihedral_p1_deg);
  expect_same(a.quality.gradation_p99, b.quality.gradation_p99);
  expect_same(a.topology.surface_area_mm2, b.topology.surface_area_mm2);
  expect_same(a.topology.normal_jump_mean_deg, b.topology.normal_jump_mean_deg);
  EXPECT_EQ(a.topology.volume_euler, b.topology.volume_euler);
  EXPECT_EQ(a.fidelity.common_voxels, b.fidelity.common_voxels);
  for (const auto way : {&SurfaceDistance::mesh_to_image, &SurfaceDistance::image_to_mesh}) {
    expect_same((a.fidelity.distance.*way).mean_mm, (b.fidelity.distance.*way).mean_mm);
    expect_same((a.fidelity.distance.*way).p95_mm, (b.fidelity.distance.*way).p95_mm);
    expect_same((a.fidelity.distance.*way).max_mm, (b.fidelity.distance.*way).max_mm);
  }
}

TEST(Assess, DoesNotDependOnTheNumberOfThreads) {
  const LabelImage image = testing::anisotropic(testing::random_blobs(3, 32, 12));
  const TetMesh mesh = testing::jittered(mesh_of_voxels(image), 0.3);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return assess(mesh, &image);
  };
  const Assessment one = with_threads(1), four = with_threads(4);
  expect_same(one.whole, four.whole);
  ASSERT_EQ(one.tissues.size(), four.tissues.size());
  for (std::size_t t = 0; t < one.tissues.size(); ++t) expect_same(one.tissues[t], four.tissues[t]);
  expect_same(one.summary.surface_mean_mm, four.summary.surface_mean_mm);
}

TEST(Assess, WithoutAnImageHasNoFidelity) {
  const Assessment a = assess(mesh_of_voxels(testing::nested_spheres()));
  EXPECT_FALSE(a.has_image);
  EXPECT_EQ(a.tissues.size(), 3u);
  EXPECT_EQ(a.tissues.back().label, 4294967295u);
  EXPECT_EQ(a.summary.labels_in_mesh, 3u);
  EXPECT_TRUE(a.summary.extra_labels.empty());
  EXPECT_TRUE(std::isnan(a.summary.mean_dice));
  EXPECT_TRUE(std::isnan(a.whole.fidelity.distance.mean_mm));
}

TEST(Assess, DistancesCanBeLeftOut) {
  const LabelImage image = testing::sphere(5);
  AssessOptions options;
  options.distances = false;
  const Assessment a = assess(mesh_of_voxels(image), &image, options);
  EXPECT_FALSE(a.has_distances);
  EXPECT_EQ(a.whole.fidelity.dice, 1);
  EXPECT_TRUE(std::isnan(a.whole.fidelity.distance.mean_mm));
}

TEST(Assess, ReportsProgressThatNeverFallsAndCanBeCancelled) {
  const LabelImage image = testing::random_blobs(1);
  const TetMesh mesh = mesh_of_voxels(image);
  double last = 0;
  Progress progress;
  progress.report = [&](std::string_view, double fraction) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1);
    last = fraction;
  };
  assess(mesh, &image, {}, progress);
  EXPECT_GT(last, 0.2);

  std::stop_source stop;
  progress.report = [&](std::string_view stage, double) {
    if (stage == "fidelity") stop.request_stop();
  };
  progress.cancel = stop.get_token();
  EXPECT_THROW(assess(mesh, &image, {}, progress), Cancelled);
}

TEST(Assess, ImageWhoseSizeAndVoxelsDisagreeIsRefused) {
  LabelImage image = testing::sphere(3);
  const TetMesh mesh = mesh_of_voxels(image);
  image.voxels.pop_back();
  EXPECT_THROW(assess(mesh, &image), InvalidInput);
}

bool has(const std::vector<std::string>& sentences, const std::string& part) {
  for (const auto& s : sentences) {
    if (s.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(Guarantees, AllHoldForRegularVoxels) {
  const LabelImage image = testing::oblique(testing::four_label_point());
  const TetMesh mesh = mesh_of_voxels(image, testing::VoxelCut::five);
  EXPECT_EQ(failed_guarantees(assess(mesh, &image)), std::vector<std::string>{});
}

TEST(Guarantees, BoundsAreKeptExactly) {
  const Assessment a = assess(mesh_of_voxels(testing::sphere(4)));
  AssessOptions options;
  options.min_dihedral_deg = a.whole.quality.min_dihedral_deg;  // 45
  options.max_dihedral_deg = a.whole.quality.max_dihedral_deg;  // 90
  options.min_mean_ratio = a.whole.quality.min_mean_ratio;
  EXPECT_TRUE(failed_guarantees(a, options).empty());
  options.min_dihedral_deg += 1e-3;
  options.max_dihedral_deg -= 1e-3;
  options.min_mean_ratio += 1e-6;
  const auto failed = failed_guarantees(a, options);
  EXPECT_EQ(failed.size(), 3u);
  EXPECT_TRUE(has(failed, "smallest dihedral angle"));
  EXPECT_TRUE(has(failed, "largest dihedral angle"));
  EXPECT_TRUE(has(failed, "mean ratio"));
}

TEST(Guarantees, LabelsAndPlace) {
  const LabelImage image = testing::two_touching_cubes();
  TetMesh mesh = testing::moved(mesh_of_voxels(image), [](Vec3 p) { return Vec3{p.x, p.y + 8, p.z}; });
  for (Label& l : mesh.labels) {
    if (l == 2) l = 5;
  }
  const auto failed = failed_guarantees(assess(mesh, &image));
  EXPECT_TRUE(has(failed, "label 2 of the image (1000 voxels) is missing"));
  EXPECT_TRUE(has(failed, "label 5 of the mesh (6000 tetrahedra) is not in the image"));
  EXPECT_TRUE(has(failed, "does not lie in the image"));
  EXPECT_EQ(failed.size(), 3u);
}

TEST(Guarantees, Validity) {
  TetMesh mesh = mesh_of_voxels(testing::sphere(3));
  std::swap(mesh.tets[5][0], mesh.tets[5][1]);
  mesh.points_mm.push_back({0, 0, 0});
  const auto failed = failed_guarantees(assess(mesh));
  EXPECT_TRUE(has(failed, "1 tetrahedron is inverted"));
  EXPECT_TRUE(has(failed, "1 vertex belongs to no tetrahedron"));
  EXPECT_TRUE(has(failed_guarantees(assess(TetMesh{})), "no labelled tetrahedron"));
}

}  // namespace
}  // namespace anatomesh
