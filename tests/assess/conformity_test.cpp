#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "anatomesh/assess.h"
#include "anatomesh/errors.h"
#include "anatomesh/quadratic.h"
#include "base/vec.h"
#include "support/test_images.h"
#include "support/test_meshes.h"
#include "voxel_mesh.h"

namespace anatomesh {
namespace {

using testing::make_image;
using testing::mesh_of_voxels;
using testing::VoxelCut;

LabelImage block(std::array<std::size_t, 3> size) {
  return make_image(size, [](int, int, int) { return Label{1}; });
}

TEST(Conformity, EveryShapeAsVoxelsIsConforming) {
  for (const auto& [name, image] : testing::all_test_images()) {
    const TetMesh mesh = mesh_of_voxels(image);
    if (mesh.tets.size() > 60000) continue;
    AssessOptions options;
    options.distances = false;
    const Conformity c = assess(mesh, &image, options).conformity;
    EXPECT_EQ(c.faces_in_more_than_two_tets, 0u) << name;
    EXPECT_EQ(c.duplicate_vertices, 0u) << name;
    EXPECT_EQ(c.unused_vertices, 0u) << name;
    EXPECT_EQ(c.hanging_vertices, 0u) << name;
    EXPECT_EQ(c.outer_faces_with_material_outside, 0u) << name;
    EXPECT_EQ(c.folded_tets, 0u) << name;
    EXPECT_EQ(c.voxel_centres_in_several_tets, 0u) << name;
    EXPECT_FALSE(c.negative_orientation) << name;
  }
}

TEST(Curves, FoldedTetrahedraBreakAGuarantee) {
  TetMesh mesh = quadratic_mesh(testing::two_tets(1, 2));
  EXPECT_EQ(failed_guarantees(assess(mesh), {.min_mean_ratio = 0}), std::vector<std::string>());
  EXPECT_EQ(assess(mesh).curves.curved_tets, 0u);
  EXPECT_NEAR(assess(mesh).curves.min_jacobian, 1, 1e-12);
  const auto& shared = mesh.edge_nodes[0];
  const VertexId node = *std::ranges::find_if(mesh.edge_nodes[1],
                                              [&](VertexId v) { return std::ranges::find(shared, v) == shared.end(); });
  mesh.points_mm[node] = mesh.points_mm[node] + Vec3{0.1, 0.1, 0.1};
  EXPECT_EQ(assess(mesh).curves.curved_tets, 1u);
  mesh.points_mm[node] = {-3, -3, -3};
  const Assessment folded = assess(mesh);
  EXPECT_EQ(folded.curves.folded, 1u);
  EXPECT_LT(folded.curves.min_jacobian, 0);
  EXPECT_NE(failed_guarantees(folded).front().find("1 curved tetrahedron may be folded"), std::string::npos);
}

TEST(Curves, EdgeNodesThatDoNotFitAreRefused) {
  TetMesh mesh = quadratic_mesh(testing::two_tets(1, 2));
  mesh.edge_nodes.pop_back();
  EXPECT_THROW(assess(mesh), InvalidInput);
  mesh = quadratic_mesh(testing::two_tets(1, 2));
  mesh.edge_nodes[0][3] = 99;
  EXPECT_THROW(assess(mesh), InvalidInput);
}

TEST(Conformity, FaceInThreeTetrahedra) {
  TetMesh mesh = testing::corner_tet();
  mesh.points_mm.insert(mesh.points_mm.end(), {{0, 0, -1}, {0.1, 0.1, -2}});
  mesh.tets.insert(mesh.tets.end(), {{0, 2, 1, 4}, {0, 2, 1, 5}});
  mesh.labels = {1, 1, 1};
  EXPECT_EQ(assess(mesh).conformity.faces_in_more_than_two_tets, 1u);
}

TEST(Conformity, TetrahedraOnTheSameSideOfTheirFaceAreFolded) {
  TetMesh twice = testing::corner_tet();
  twice.tets.push_back(twice.tets[0]);
  twice.labels.push_back(2);
  const Assessment same = assess(twice);
  EXPECT_EQ(same.conformity.folded_tets, 1u);
  EXPECT_FALSE(failed_guarantees(same, {.min_dihedral_deg = 0, .max_dihedral_deg = 180, .min_mean_ratio = 0}).empty());
  TetMesh over = testing::corner_tet();
  over.points_mm.push_back({0.2, 0.2, 2});
  over.tets.push_back({0, 1, 2, 4});
  over.labels.push_back(1);
  EXPECT_EQ(assess(over).conformity.folded_tets, 1u);
}

TEST(Conformity, DuplicateAndUnusedVertices) {
  TetMesh mesh = mesh_of_voxels(block({2, 2, 2}));
  mesh.points_mm.push_back({50, 0, 0});  // unused
  const VertexId n = static_cast<VertexId>(mesh.points_mm.size());
  const VertexId torn = mesh.tets[0][0];
  mesh.points_mm.push_back(mesh.points_mm[torn]);
  mesh.tets[0][0] = n;
  const Conformity c = assess(mesh).conformity;
  EXPECT_EQ(c.unused_vertices, 1u);
  EXPECT_EQ(c.duplicate_vertices, 1u);
  EXPECT_EQ(c.hanging_vertices, 0u);
}

TEST(Conformity, VertexHangingOnAFace) {
  // The lower tetrahedron meets three upper ones that share a vertex inside its top face.
  TetMesh mesh;
  mesh.points_mm = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, -3}, {0.9, 1.2, 0}, {1, 1, 3}};
  mesh.tets = {{0, 2, 1, 3}, {0, 1, 4, 5}, {1, 2, 4, 5}, {2, 0, 4, 5}};
  mesh.labels = {1, 1, 1, 1};
  const Conformity c = assess(mesh).conformity;
  EXPECT_EQ(c.hanging_vertices, 1u);
  EXPECT_EQ(c.outer_faces_with_material_outside, 4u);
}

TEST(Conformity, VertexHangingOnAnEdgeAwayFromItsMiddle) {
  TetMesh mesh;
  mesh.points_mm = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, -3}, {1.1, 0, 0}, {1, 1, 3}};
  mesh.tets = {{0, 2, 1, 3}, {0, 4, 2, 5}, {4, 1, 2, 5}};
  mesh.labels = {1, 1, 1};
  EXPECT_EQ(assess(mesh).conformity.hanging_vertices, 1u);
}

TEST(Conformity, OneVoxelCutOtherwiseLeavesNoHangingVertexButFacesOnFaces) {
  // Diagonals that cross: no vertex hangs, yet the faces between the two voxels are outer ones with material outside.
  const LabelImage image = block({2, 1, 1});
  TetMesh mesh = mesh_of_voxels(image);
  for (Vec3& p : mesh.points_mm) p.y = -p.y;
  TetMesh second = mesh_of_voxels(image);
  TetMesh joined;
  joined.points_mm = second.points_mm;
  for (std::size_t t = 0; t < second.tets.size(); ++t) {
    auto tet = second.tets[t];
    if (t >= 6) {  // the mirrored cut of the second voxel
      for (VertexId& v : tet) {
        for (VertexId w = 0; w < mesh.points_mm.size(); ++w) {
          if (second.points_mm[w] == mesh.points_mm[v]) {
            v = w;
            break;
          }
        }
      }
      std::swap(tet[0], tet[1]);
    }
    joined.tets.push_back(tet);
    joined.labels.push_back(1);
  }
  // Within the common side, so that no diagonal passes through the middle of a triangle.
  joined = testing::moved(joined, [](Vec3 p) { return p == Vec3{0.5, 0.5, 0.5} ? Vec3{0.5, 0.6, 0.7} : p; });
  const Assessment a = assess(joined, &image);
  EXPECT_EQ(a.whole.quality.inverted, 0u);
  EXPECT_EQ(a.conformity.hanging_vertices, 0u);
  EXPECT_EQ(a.conformity.outer_faces_with_material_outside, 4u);
  EXPECT_EQ(a.conformity.voxel_centres_in_several_tets, 0u);
}

TEST(Conformity, OverlappingPartsShareVoxelCentres) {
  const LabelImage image = block({4, 4, 4});
  TetMesh mesh = testing::moved(mesh_of_voxels(image), [](Vec3 p) { return Vec3{p.x + 0.01, p.y + 0.02, p.z + 0.05}; });
  const TetMesh again = testing::moved(mesh, [](Vec3 p) { return Vec3{p.x + 2.03, p.y + 0.011, p.z + 0.007}; });
  const VertexId n = static_cast<VertexId>(mesh.points_mm.size());
  mesh.points_mm.insert(mesh.points_mm.end(), again.points_mm.begin(), again.points_mm.end());
  for (auto t : again.tets) {
    for (VertexId& v : t) v += n;
    mesh.tets.push_back(t);
  }
  mesh.labels.insert(mesh.labels.end(), again.labels.begin(), again.labels.end());
  const Conformity c = assess(mesh, &image).conformity;
  EXPECT_EQ(c.voxel_centres_in_several_tets, 2u * 4 * 4);
  EXPECT_GT(c.outer_faces_with_material_outside, 0u);
}

TEST(Conformity, CutsWithFiveAndTwelveTetrahedraConform) {
  for (const VoxelCut cut : {VoxelCut::five, VoxelCut::twelve}) {
    const Conformity c = assess(mesh_of_voxels(block({3, 2, 2}), cut)).conformity;
    EXPECT_EQ(c.outer_faces, 2u * 2 * (3 * 2 + 3 * 2 + 2 * 2));
    EXPECT_EQ(c.hanging_vertices, 0u);
  }
}

}  // namespace
}  // namespace anatomesh
