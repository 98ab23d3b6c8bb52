#include "mesh/mesh_editor.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/vec.h"
#include "mesh/cube_mesh.h"
#include "mesh/edge_ring.h"
#include "mesh/expect_sound.h"
#include "mesh/mesh_checks.h"
#include "mesh/tissue_topology.h"
#include "mesh/vertex_star.h"

namespace anatomesh {
namespace {

constexpr std::array<int, 3> kCubes = {4, 4, 4};

/// Two tissues side by side in a cushion that is one cube thick.
TissueMesh two_boxes() {
  return testing::cube_mesh(kCubes, [](int i, int j, int k) {
    const bool inside = std::min({i, j, k}) > 0 && std::max({i, j, k}) < 3;
    return !inside ? 0 : i < 2 ? 1 : 2;
  });
}

VertexId vertex(int x, int y, int z) { return testing::cube_mesh_vertex(kCubes, x, y, z); }

void expect_sound(const TissueMesh& mesh) { testing::expect_sound(mesh.points_mm, mesh.tets); }

/// The lists of tetrahedra at the vertices, and what is known of the vertices, are those of the mesh.
void expect_consistent(const MeshEditor& editor) {
  std::vector<std::set<TetId>> at(editor.vertex_count());
  for (TetId t = 0; t < editor.tet_count(); ++t) {
    if (!editor.is_alive(t)) continue;
    for (const VertexId v : editor.tet(t)) at[v].insert(t);
  }
  const MeshEditor again(editor.result());
  EXPECT_EQ(again.tissue_tets(), editor.tissue_tets());
  for (VertexId v = 0; v < editor.vertex_count(); ++v) {
    const auto tets = editor.tets_at(v);
    EXPECT_EQ(std::set<TetId>(tets.begin(), tets.end()), at[v]);
    EXPECT_EQ(tets.size(), at[v].size());
    std::set<TissueId> tissues;
    for (const TetId t : tets) tissues.insert(editor.tissue(t));
    EXPECT_TRUE(tets.empty() || editor.tissues_at(v) == static_cast<int>(tissues.size()));
  }
}

TEST(MeshEditor, GivesBackWhatItWasGiven) {
  const TissueMesh mesh = with_cushion_last(two_boxes());
  const TissueMesh result = MeshEditor(mesh).result();
  EXPECT_EQ(result.tets, mesh.tets);
  EXPECT_EQ(result.tissues, mesh.tissues);
  EXPECT_EQ(result.points_mm, mesh.points_mm);
}

TEST(MeshEditor, KnowsWhatMeetsAtAVertex) {
  const MeshEditor editor(two_boxes());
  EXPECT_EQ(editor.tissues_at(vertex(0, 0, 0)), 1);
  EXPECT_EQ(editor.tissues_at(vertex(1, 1, 1)), 2);
  EXPECT_EQ(editor.tissues_at(vertex(2, 2, 2)), 2);
  EXPECT_EQ(editor.tissues_at(vertex(2, 2, 1)), 3);
  for (VertexId v = 0; v < editor.vertex_count(); ++v) {
    const Vec3 p = editor.point(v);
    EXPECT_EQ(editor.is_outer(v), std::min({p.x, p.y, p.z}) == 0 || std::max({p.x, p.y, p.z}) == 4);
  }
}

TEST(MeshEditor, CollapseAlongAnInterfaceKeepsTheMeshWhole) {
  const TissueMesh mesh = two_boxes();
  MeshEditor editor(mesh);
  editor.collapse(vertex(2, 2, 2), vertex(2, 1, 2));
  expect_consistent(editor);
  const TissueMesh result = editor.result();
  EXPECT_LT(result.tets.size(), mesh.tets.size());
  EXPECT_EQ(testing::topology_of(result), testing::topology_of(mesh));
  for (const auto& [tissue, volume] : testing::volumes_of(mesh))
    EXPECT_NEAR(testing::volumes_of(result).at(tissue), volume, 1e-9);
}

TEST(MeshEditor, SplitsEveryKindOfEdge) {
  const TissueMesh mesh = two_boxes();
  MeshEditor editor(mesh);
  const std::vector<std::pair<VertexId, VertexId>> edges = {{vertex(0, 0, 0), vertex(1, 0, 0)},   // outer
                                                            {vertex(2, 1, 1), vertex(2, 2, 1)},   // junction
                                                            {vertex(2, 2, 2), vertex(2, 2, 3)},   // interface
                                                            {vertex(1, 2, 2), vertex(2, 2, 2)}};  // inside tissue 1
  for (const auto& [a, b] : edges) {
    const VertexId m = editor.split(a, b, 0.5 * (editor.point(a) + editor.point(b)));
    EXPECT_EQ(editor.is_outer(m), a == vertex(0, 0, 0));
    expect_consistent(editor);
  }
  expect_sound(editor.result());
  EXPECT_EQ(testing::topology_of(editor.result()), testing::topology_of(mesh));
}

TEST(EdgeRing, GoesOnceAround) {
  const TissueMesh mesh = two_boxes();
  const MeshEditor editor(mesh);
  EdgeRing ring;
  ASSERT_TRUE(find_ring(editor, vertex(1, 2, 2), vertex(2, 2, 2), ring));
  for (std::size_t n = 0; n < ring.size; ++n) {
    const VertexId x = ring.link[n], y = ring.link[(n + 1) % ring.size];
    const testing::Tet tet = {ring.a, ring.b, x, y};
    EXPECT_GT(testing::shape_of(testing::corners_of(mesh.points_mm, tet)).volume, 0);
    auto expected = editor.tet(ring.tets[n]), corners = tet;
    std::sort(expected.begin(), expected.end());
    std::sort(corners.begin(), corners.end());
    EXPECT_EQ(corners, expected);
  }
  EXPECT_FALSE(find_ring(editor, vertex(0, 0, 0), vertex(1, 0, 0), ring)) << "on the outer boundary";
}

TEST(VertexStar, HasEachFaceOnce) {
  const MeshEditor editor(two_boxes());
  VertexStar star(editor);
  for (const auto& [v, tissues] :
       {std::pair{vertex(2, 2, 2), 2}, std::pair{vertex(2, 2, 1), 3}, std::pair{vertex(1, 1, 1), 2}}) {
    star.gather(v);
    EXPECT_EQ(star.tets().size(), editor.tets_at(v).size());
    EXPECT_EQ(star.vertices()[0], v);
    // Around an inner vertex: a sphere of as many triangles as tetrahedra, edges as faces, corners as neighbours.
    const std::size_t edges = star.gather_faces().size();
    EXPECT_EQ(2 * edges, 3 * star.tets().size());
    EXPECT_EQ(star.vertices().size() - 1 + star.tets().size(), edges + 2);
    EXPECT_TRUE(star.each_tissue_is_one_piece(tissues));
    EXPECT_FALSE(star.each_tissue_is_one_piece(tissues + 1));
  }
}

TEST(VertexStar, SeesATissueThatTouchesItselfAtAVertex) {
  const MeshEditor editor(testing::cube_mesh(kCubes, [](int i, int j, int k) {
    return (i == 1 && j == 1 && k == 1) || (i == 2 && j == 2 && k == 2) ? 1 : 0;
  }));
  VertexStar star(editor);
  star.gather(vertex(2, 2, 2));
  star.gather_faces();
  EXPECT_FALSE(star.each_tissue_is_one_piece(2));
}

}  // namespace
}  // namespace anatomesh
