#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "anatomesh/assess.h"
#include "support/test_images.h"
#include "support/test_meshes.h"
#include "voxel_mesh.h"

namespace anatomesh {
namespace {

using testing::make_image;

struct Both {
  explicit Both(const LabelImage& image) : topology(assess(testing::mesh_of_voxels(image), &image).whole.topology) {}
  Topology topology;
};

LabelImage voxels(const std::vector<std::array<int, 3>>& at) {
  return make_image({6, 6, 6}, [&](int i, int j, int k) {
    return Label{std::find(at.begin(), at.end(), std::array{i, j, k}) != at.end()};
  });
}

TEST(Topology, OneVoxel) {
  const Topology t = Both(voxels({{2, 2, 2}})).topology;
  EXPECT_EQ(t.tet_components, 1u);
  EXPECT_EQ(t.volume_euler, 1);
  EXPECT_EQ(t.image_euler, 1);
  EXPECT_EQ(t.surface_euler, 2);
  EXPECT_EQ(t.surface_components, 1u);
  EXPECT_EQ(t.surface_vertices, 8u);
  EXPECT_EQ(t.surface_edges, 18u);
  EXPECT_EQ(t.surface_faces, 12u);
  EXPECT_DOUBLE_EQ(t.surface_area_mm2, 6);
  EXPECT_TRUE(t.closed);
  EXPECT_EQ(t.nonmanifold_edges, 0u);
  EXPECT_EQ(t.nonmanifold_vertices, 0u);
  EXPECT_NEAR(t.normal_jump_mean_deg, 12 * 90.0 / 18, 1e-9);  // six diagonals are flat
  EXPECT_NEAR(t.normal_jump_p95_deg, 90, 1e-9);
}

TEST(Topology, CubesThatTouchAtACorner) {
  const Topology t = Both(voxels({{1, 1, 1}, {2, 2, 2}})).topology;
  EXPECT_EQ(t.tet_components, 2u);
  EXPECT_EQ(t.image_components_6, 2u);
  EXPECT_EQ(t.image_components_26, 1u);
  EXPECT_EQ(t.volume_euler, 1);
  EXPECT_EQ(t.image_euler, 1);
  EXPECT_EQ(t.surface_components, 2u);
  EXPECT_EQ(t.nonmanifold_edges, 0u);
  EXPECT_EQ(t.nonmanifold_vertices, 1u);
  EXPECT_EQ(t.pinch_vertices, 1u);
  EXPECT_TRUE(t.closed);
}

TEST(Topology, CubesThatTouchAtAnEdge) {
  const Topology t = Both(voxels({{1, 1, 1}, {2, 2, 1}})).topology;
  EXPECT_EQ(t.tet_components, 2u);
  EXPECT_EQ(t.image_components_6, 2u);
  EXPECT_EQ(t.image_components_26, 1u);
  EXPECT_EQ(t.surface_components, 1u);
  EXPECT_EQ(t.nonmanifold_edges, 1u);
  EXPECT_EQ(t.nonmanifold_vertices, 2u);
  EXPECT_EQ(t.pinch_vertices, 0u);
  EXPECT_TRUE(t.closed);  // four faces
}

TEST(Topology, Torus) {
  const Topology t = Both(testing::torus()).topology;
  EXPECT_EQ(t.volume_euler, 0);
  EXPECT_EQ(t.image_euler, 0);
  EXPECT_EQ(t.surface_euler, 0);
  EXPECT_EQ(t.tet_components, 1u);
}

TEST(Topology, SquareRingOfEightVoxels) {
  const Topology t = Both(make_image({5, 5, 3}, [](int i, int j, int k) {
                       return Label{k == 1 && i >= 1 && i <= 3 && j >= 1 && j <= 3 && !(i == 2 && j == 2)};
                     })).topology;
  EXPECT_EQ(t.volume_euler, 0);
  EXPECT_EQ(t.image_euler, 0);
  EXPECT_EQ(t.surface_euler, 0);
}

TEST(Topology, HollowSphereHasTwoSurfaces) {
  const Topology t = Both(testing::hollow_sphere()).topology;
  EXPECT_EQ(t.surface_components, 2u);
  EXPECT_EQ(t.volume_euler, 2);
  EXPECT_EQ(t.image_euler, 2);
  EXPECT_EQ(t.surface_euler, 4);
}

TEST(Topology, InterfacesBelongToBothTissues) {
  const LabelImage image = testing::two_touching_cubes();
  const Assessment a = assess(testing::mesh_of_voxels(image), &image);
  for (const auto& t : a.tissues) {
    EXPECT_TRUE(t.topology.closed);
    EXPECT_EQ(t.topology.surface_euler, 2);
    EXPECT_DOUBLE_EQ(t.topology.surface_area_mm2, 600);
  }
  EXPECT_DOUBLE_EQ(a.whole.topology.surface_area_mm2, 1000);
}

TEST(Topology, SurfaceOpenWhereAFaceIsInThreeTetrahedra) {
  TetMesh mesh = testing::corner_tet();
  mesh.points_mm.insert(mesh.points_mm.end(), {{0, 0, -1}, {0.1, 0.1, -2}});
  mesh.tets.insert(mesh.tets.end(), {{0, 2, 1, 4}, {0, 2, 1, 5}});
  mesh.labels = {1, 1, 1};
  const Assessment a = assess(mesh);
  EXPECT_FALSE(a.whole.topology.closed);
  EXPECT_EQ(a.whole.topology.odd_edges, 3u);
  EXPECT_EQ(a.summary.open_surfaces, std::vector<Label>{1});
}

TEST(Topology, NoiseAgreesWithTheVoxelsThemselves) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const LabelImage image = testing::noise(seed);
    for (const auto& t : assess(testing::mesh_of_voxels(image), &image).tissues) {
      EXPECT_EQ(t.topology.volume_euler, t.topology.image_euler);
      EXPECT_EQ(t.topology.tet_components, t.topology.image_components_6);
      EXPECT_TRUE(t.topology.closed);
    }
  }
}

}  // namespace
}  // namespace anatomesh
