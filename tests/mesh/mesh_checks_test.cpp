// The oracles themselves: each must see the fault that it is there for.
#include "mesh/mesh_checks.h"

#include <gtest/gtest.h>

#include "mesh/cube_mesh.h"

namespace anatomesh::testing {
namespace {

TissueMesh one_cube() {
  return cube_mesh({1, 1, 1}, [](int, int, int) { return 1; });
}

TEST(MeshChecks, SoundMeshHasNoFault) {
  const TissueMesh mesh = cube_mesh({2, 2, 2}, [](int, int, int) { return 1; });
  EXPECT_EQ(crowded_faces(mesh.points_mm, mesh.tets), 0u);
  EXPECT_EQ(vertices_in_edge_middles(mesh.points_mm, mesh.tets), 0u);
  EXPECT_EQ(vertices_inside_outer_faces(mesh.points_mm, mesh.tets), 0u);
  EXPECT_EQ(duplicate_vertices(mesh.points_mm), 0u);
  EXPECT_EQ(unused_vertices(mesh.points_mm.size(), mesh.tets), 0u);
}

TEST(MeshChecks, SeesDuplicateAndUnusedVertices) {
  TissueMesh mesh = one_cube();
  mesh.points_mm.push_back(mesh.points_mm[3]);
  EXPECT_EQ(duplicate_vertices(mesh.points_mm), 1u);
  EXPECT_EQ(unused_vertices(mesh.points_mm.size(), mesh.tets), 1u);
}

TEST(MeshChecks, SeesCrowdedFaces) {
  TissueMesh mesh = one_cube();
  mesh.tets.push_back(mesh.tets[0]);
  EXPECT_GT(crowded_faces(mesh.points_mm, mesh.tets), 0u);
}

// Two tetrahedra that share a face, of which one was halved through an edge of it.
TEST(MeshChecks, SeesHangingNodes) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {0, 0, -2}, {1, 0, 0}};
  const std::vector<Tet> tets = {{0, 1, 2, 3}, {0, 5, 4, 2}, {5, 1, 4, 2}};
  EXPECT_EQ(vertices_in_edge_middles(points, tets), 1u);
  EXPECT_GT(vertices_inside_outer_faces(points, tets), 0u);
}

TEST(MeshChecks, SeesInvertedTets) {
  TissueMesh mesh = one_cube();
  std::swap(mesh.tets[2][0], mesh.tets[2][1]);
  EXPECT_LT(smallest_volume(mesh.points_mm, mesh.tets), 0);
}

TEST(MeshChecks, BarycentricCoordinatesOfCornersAndCentre) {
  const Corners corners = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  EXPECT_EQ(barycentric_of(corners, corners[2]), (std::array<double, 4>{0, 0, 1, 0}));
  EXPECT_DOUBLE_EQ(depth_inside(corners, {0.25, 0.25, 0.25}), 0.25);
  EXPECT_LT(depth_inside(corners, {1, 1, 1}), 0);
}

}  // namespace
}  // namespace anatomesh::testing
