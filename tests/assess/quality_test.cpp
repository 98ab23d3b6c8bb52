#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "anatomesh/assess.h"
#include "anatomesh/errors.h"
#include "support/test_images.h"
#include "support/test_meshes.h"
#include "voxel_mesh.h"

namespace anatomesh {
namespace {

using testing::corner_tet;
using testing::single_tet;

double deg(double radians) { return radians * 180 / std::numbers::pi; }

Quality quality_of(const TetMesh& mesh) { return assess(mesh).whole.quality; }

TEST(Quality, RegularTetrahedron) {
  const Quality q = quality_of(single_tet({{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}}));
  const double angle = deg(std::acos(1.0 / 3));
  EXPECT_EQ(q.tets, 1u);
  EXPECT_EQ(q.vertices, 4u);
  EXPECT_EQ(q.edges, 6u);
  EXPECT_NEAR(q.min_dihedral_deg, angle, 1e-12);
  EXPECT_NEAR(q.max_dihedral_deg, angle, 1e-12);
  EXPECT_NEAR(q.dihedral_median_deg, angle, 1e-12);
  EXPECT_NEAR(q.min_mean_ratio, 1, 1e-12);
  EXPECT_NEAR(q.mean_scaled_jacobian, 1, 1e-12);
  EXPECT_NEAR(q.volume_mm3, 8.0 / 3, 1e-12);
  EXPECT_NEAR(q.mean_edge_mm, std::sqrt(8), 1e-12);
  EXPECT_EQ(q.max_gradation, 1);
  EXPECT_EQ(q.dihedral_histogram[14], 6u);  // 70.5 degrees
}

TEST(ShapeSummary, SaysWhatQualityDoes) {
  TetMesh mesh = corner_tet();
  mesh.points_mm.push_back({1, 1, 1.5});
  mesh.tets.push_back({1, 2, 3, 4});
  mesh.labels.push_back(2);
  const ShapeSummary shapes = summarise_shapes(mesh);
  const Quality q = quality_of(mesh);
  EXPECT_EQ(shapes.min_dihedral_deg, q.min_dihedral_deg);
  EXPECT_EQ(shapes.max_dihedral_deg, q.max_dihedral_deg);
  EXPECT_EQ(shapes.min_mean_ratio, q.min_mean_ratio);
  EXPECT_NEAR(shapes.mean_mean_ratio, q.mean_mean_ratio, 1e-15);
  EXPECT_TRUE(std::isnan(summarise_shapes({}).min_dihedral_deg));
}

TEST(Quality, RightCornerTetrahedron) {
  const Quality q = quality_of(corner_tet());
  EXPECT_NEAR(q.min_dihedral_deg, deg(std::acos(1 / std::sqrt(3))), 1e-12);
  EXPECT_NEAR(q.max_dihedral_deg, 90, 1e-12);
  EXPECT_NEAR(q.min_mean_ratio, 12 * std::pow(0.5, 2.0 / 3) / 9, 1e-12);
  EXPECT_NEAR(q.min_scaled_jacobian, 1 / std::sqrt(2), 1e-12);  // J = 1, largest product 1 * sqrt 2 * sqrt 2 = 2
  EXPECT_NEAR(q.volume_mm3, 1.0 / 6, 1e-15);
  EXPECT_NEAR(q.max_edge_ratio, std::sqrt(2), 1e-12);
}

TEST(Quality, NeedleHasGoodAnglesButASmallMeanRatio) {
  const double r = std::sqrt(3) / 2;
  const Quality q = quality_of(single_tet({{{1, 0, 0}, {-0.5, r, 0}, {-0.5, -r, 0}, {0, 0, 20}}}));
  EXPECT_GT(q.min_dihedral_deg, 59);
  EXPECT_LT(q.min_mean_ratio, 0.15);
}

TEST(Quality, SliverAnglesStayExactNearZero) {
  // Crossing edges of length 2 a height h apart: 180 degrees less 2 atan(h) at those, about sqrt(2) h at the others.
  const double h = 1e-7;
  const Quality q = quality_of(single_tet({{{-1, 0, 0}, {1, 0, 0}, {0, -1, h}, {0, 1, h}}}));
  EXPECT_NEAR(q.max_dihedral_deg, 180 - deg(2 * std::atan(h)), 1e-11);
  EXPECT_NEAR(q.min_dihedral_deg / deg(std::sqrt(2) * h), 1, 1e-6);
  EXPECT_EQ(q.share_below_5_deg, 1);
  EXPECT_EQ(q.share_above_165_deg, 1);
  EXPECT_EQ(q.dihedral_histogram[0], 4u);
  EXPECT_EQ(q.dihedral_histogram[35], 2u);
}

TEST(Quality, InvertedAndFlatOnesAreCounted) {
  TetMesh mesh = testing::mesh_of_voxels(testing::sphere(3));
  std::swap(mesh.tets[0][0], mesh.tets[0][1]);
  const VertexId n = static_cast<VertexId>(mesh.points_mm.size());
  for (const Vec3 p : {Vec3{90, 0, 0}, {91, 0, 0}, {90, 1, 0}, {91, 1, 0}}) mesh.points_mm.push_back(p);
  mesh.tets.push_back({n, n + 1, n + 2, n + 3});
  mesh.labels.push_back(1);
  const Assessment a = assess(mesh);
  EXPECT_FALSE(a.conformity.negative_orientation);
  EXPECT_EQ(a.whole.quality.inverted, 1u);
  EXPECT_EQ(a.whole.quality.degenerate, 1u);
  EXPECT_EQ(a.whole.quality.min_mean_ratio, 0);
}

TEST(Quality, MirroredMeshIsNamedOnceAndMeasuredTurnedRound) {
  TetMesh mesh = testing::mesh_of_voxels(testing::sphere(3));
  const Quality right = quality_of(mesh);
  for (auto& t : mesh.tets) std::swap(t[2], t[3]);
  const Assessment a = assess(mesh);
  EXPECT_TRUE(a.conformity.negative_orientation);
  EXPECT_EQ(a.whole.quality.inverted, 0u);
  EXPECT_DOUBLE_EQ(a.whole.quality.volume_mm3, right.volume_mm3);
  EXPECT_TRUE(a.whole.topology.closed);
}

TEST(Quality, TwoTetrahedraSharingAFace) {
  TetMesh mesh = corner_tet();
  mesh.points_mm.push_back({0, 0, -3});
  mesh.tets.push_back({0, 2, 1, 4});
  mesh.labels.push_back(7);
  const Assessment a = assess(mesh);
  EXPECT_EQ(a.conformity.faces, 7u);
  EXPECT_EQ(a.conformity.outer_faces, 6u);
  EXPECT_EQ(a.whole.quality.edges, 9u);
  EXPECT_NEAR(a.whole.quality.max_gradation, 3, 1e-12);
  EXPECT_NEAR(a.whole.quality.gradation_p99, 3, 1e-12);
  EXPECT_EQ(a.whole.topology.tet_components, 1u);
  EXPECT_EQ(a.whole.topology.surface_faces, 6u);
  ASSERT_EQ(a.tissues.size(), 2u);
  EXPECT_EQ(a.tissues[1].label, 7u);
  EXPECT_EQ(a.tissues[1].quality.tets, 1u);
  EXPECT_EQ(a.tissues[1].quality.max_gradation, 1);  // no face within the tissue
  EXPECT_EQ(a.tissues[1].topology.surface_faces, 4u);
  EXPECT_NEAR(a.tissues[1].quality.volume_mm3, 0.5, 1e-15);
}

TEST(Quality, TissuesAddUpToTheWhole) {
  const Assessment a = assess(testing::jittered(testing::mesh_of_voxels(testing::four_label_point()), 0.2));
  std::uint64_t tets = 0, angles = 0;
  double volume = 0;
  for (const auto& t : a.tissues) {
    tets += t.quality.tets;
    volume += t.quality.volume_mm3;
    angles +=
        std::accumulate(t.quality.dihedral_histogram.begin(), t.quality.dihedral_histogram.end(), std::uint64_t{0});
  }
  EXPECT_EQ(tets, a.whole.quality.tets);
  EXPECT_EQ(angles, 6 * tets);
  EXPECT_NEAR(volume, a.whole.quality.volume_mm3, 1e-9 * volume);
}

TEST(Quality, EmptyMeshHasNoFigures) {
  const Assessment a = assess(TetMesh{});
  EXPECT_EQ(a.whole.quality.tets, 0u);
  EXPECT_TRUE(std::isnan(a.whole.quality.min_dihedral_deg));
  EXPECT_TRUE(a.tissues.empty());
}

TEST(Quality, BackgroundTetrahedraAreLeftOut) {
  TetMesh mesh = testing::mesh_of_voxels(testing::two_touching_cubes());
  const Quality before = quality_of(mesh);
  const VertexId n = static_cast<VertexId>(mesh.points_mm.size());
  for (const Vec3 p : {Vec3{90, 0, 0}, {91, 0, 0}, {90, 1, 0}, {90, 0, 1e-6}}) mesh.points_mm.push_back(p);
  mesh.tets.push_back({n, n + 1, n + 2, n + 3});
  mesh.labels.push_back(0);
  const Assessment a = assess(mesh);
  EXPECT_EQ(a.conformity.background_tets, 1u);
  EXPECT_EQ(a.conformity.unused_vertices, 0u);
  EXPECT_EQ(a.whole.quality.tets, before.tets);
  EXPECT_EQ(a.whole.quality.min_dihedral_deg, before.min_dihedral_deg);
}

TEST(Quality, BrokenArraysAreRefused) {
  TetMesh mesh = corner_tet();
  TetMesh bad = mesh;
  bad.labels.clear();
  EXPECT_THROW(assess(bad), InvalidInput);
  bad = mesh;
  bad.tets[0][2] = 4;
  EXPECT_THROW(assess(bad), InvalidInput);
  bad = mesh;
  bad.points_mm[1].y = std::nan("");
  EXPECT_THROW(assess(bad), InvalidInput);
}

}  // namespace
}  // namespace anatomesh
