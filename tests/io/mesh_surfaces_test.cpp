#include "io/mesh_surfaces.h"

#include <gtest/gtest.h>

#include "support/test_meshes.h"

namespace anatomesh::testing {
namespace {

/// Three tetrahedra in a row, each of another tissue.
TetMesh three_tissues() {
  TetMesh mesh = two_tets(3, 17);
  mesh.points_mm.push_back({2, 0, 2});
  mesh.tets.push_back({1, 5, 4, 3});
  mesh.labels.push_back(20);
  return mesh;
}

std::vector<std::string> names_of(const std::vector<MeshSurface>& surfaces) {
  std::vector<std::string> names;
  for (const MeshSurface& surface : surfaces) names.push_back(surface.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(MeshSurfaces, HaveTheNamesOfTheirTissues) {
  const TetMesh mesh = three_tissues();
  const auto surfaces = mesh_surfaces(mesh, {{3, "a"}, {17, "b"}, {20, "c"}}, 80);
  EXPECT_EQ(names_of(surfaces), (Names{"a_skin", "a_to_b", "b_skin", "b_to_c", "c_skin", "skin"}));
  EXPECT_EQ(surfaces[1].faces.size(), 1U);
  EXPECT_EQ(vertices_of(mesh, surfaces[1].faces), (std::vector<VertexId>{1, 2, 3}));
  EXPECT_EQ(surfaces[5].faces.size(), 8U);
  EXPECT_EQ(vertices_of(mesh, surfaces[5].faces).size(), 6U);
}

TEST(MeshSurfaces, LongOrEqualNamesGiveWayToLabels) {
  const std::string is_long(38, 'x');
  EXPECT_EQ(names_of(mesh_surfaces(three_tissues(), {{3, "a"}, {17, is_long}, {20, "A"}}, 40)),
            (Names{"a_skin", "interface_3_17", "skin_of_17", "interface_17_20", "skin_of_20", "skin"}));
}

TEST(MeshSurfaces, NothingHasNone) { EXPECT_TRUE(mesh_surfaces({}, {}, 80).empty()); }

}  // namespace
}  // namespace anatomesh::testing
