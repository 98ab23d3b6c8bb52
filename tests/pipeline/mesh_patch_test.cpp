// Parts of a mesh that are taken out and put back, and what goes with them.
#include "pipeline/mesh_patch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/stage.h"
#include "boundary/voxel_weights.h"
#include "deform/refine_edges.h"
#include "lattice/tet_complex.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"
#include "pipeline/meshing.h"
#include "pipeline/patch_weights.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

double volume_of(const TissueMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets)
    sum += six_volumes(mesh.points_mm[a], mesh.points_mm[b], mesh.points_mm[c], mesh.points_mm[d]) / 6;
  return sum;
}

TissueMesh blobs() { return mesh_image(testing::random_blobs(3), {}, false, {}).deformed.mesh; }

MeshPatch middle_of(const TissueMesh& mesh, int rings) {
  VoxelBlocks blocks({{10, 10, 10}, {14, 14, 14}});
  blocks.add({12, 12, 12});
  blocks.dilate(1);
  return take_patch(mesh, blocks, {1, 1, 1}, rings);
}

TEST(VoxelBlocks, MeetBoxesThatReachThem) {
  VoxelBlocks blocks({{-3, 4, 5}, {8, 9, 10}});
  blocks.add({-3, 4, 5});
  EXPECT_TRUE(blocks.meets({-6, 4, 5}, {-3, 4, 5}, {1, 1, 1}));
  EXPECT_FALSE(blocks.meets({0, 4, 5}, {8, 9, 10}, {1, 1, 1}));
  EXPECT_TRUE(blocks.meets({-100, -100, -100}, {100, 100, 100}, {1, 1, 1}));
  blocks.dilate(2);
  EXPECT_TRUE(blocks.meets({0, 4, 5}, {8, 9, 10}, {1, 1, 1}));
}

TEST(MeshPatch, PutBackItLeavesTheMeshAsItWas) {
  const TissueMesh mesh = blobs();
  for (const int rings : {0, 1, 2}) {
    const MeshPatch patch = middle_of(mesh, rings);
    ASSERT_GT(patch.tets.size(), 10u);
    ASSERT_LT(patch.tets.size(), mesh.tets.size());
    TissueMesh again = mesh;
    EXPECT_EQ(put_patch(again, patch, patch.mesh), 0u);
    EXPECT_EQ(again.points_mm, mesh.points_mm);
    EXPECT_EQ(again.tets, mesh.tets);
    EXPECT_EQ(again.tissues, mesh.tissues);
  }
}

TEST(MeshPatch, RefinedItFillsTheSameSpaceInsideTheBounds) {
  const TissueMesh mesh = blobs();
  const MeshPatch patch = middle_of(mesh, 2);
  const ShapeBounds bounds = ShapeBounds::from_degrees(20, 150, 0.3);
  const Progress quiet;
  MeshEditor editor(patch.mesh);
  const std::size_t splits = refine_edges(
      editor, bounds, [](Vec3) { return 1.0; }, 100000, Stage(quiet, "test", 0, 1));
  EXPECT_GT(splits, 20u);
  TissueMesh finer = mesh;
  put_patch(finer, patch, editor.result());
  EXPECT_GT(finer.tets.size(), mesh.tets.size());
  EXPECT_NEAR(volume_of(finer), volume_of(mesh), 1e-6);
  for (std::size_t t = 0; t < finer.tets.size(); ++t) {
    const auto& [a, b, c, d] = finer.tets[t];
    EXPECT_TRUE(within(finer.tissues[t] == 0 ? kCushionBounds : bounds, finer.points_mm[a], finer.points_mm[b],
                       finer.points_mm[c], finer.points_mm[d]));
  }
}

TEST(MeshPatch, PiecesOfTheRestAndOfThePatchMakeUpTheWhole) {
  const TissueMesh mesh = blobs();
  const std::size_t tissues = *std::ranges::max_element(mesh.tissues) + 1u;
  const RestPieces all = find_rest_pieces(mesh, {}, std::vector<char>(tissues, 1));
  const Pieces pieces = find_pieces(make_complex(mesh));
  for (std::size_t t = 1; t < tissues; ++t) {
    const auto count = std::ranges::count_if(pieces.list, [&](const Pieces::Piece& p) { return p.tissue == t; });
    EXPECT_EQ(all.closed[t], static_cast<std::uint32_t>(count)) << "tissue " << t;
  }
}

TEST(UpdatedWeights, AreThoseOfTheChangedImage) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    LabelImage image = testing::random_blobs(seed, 40, 20);
    const TissueImage before = make_tissue_image(image);
    for (std::size_t k = 18; k < 22; ++k) {
      for (std::size_t j = 18; j < 21; ++j) image.voxels[20 + 40 * (j + 40 * k)] = before.labels[1];
    }
    const TissueImage after = make_tissue_image(image);
    ASSERT_EQ(after.labels, before.labels);
    EXPECT_EQ(updated_weights(before, voxel_weights(before), after, {{20, 18, 18}, {21, 21, 22}}),
              voxel_weights(after));
  }
}

}  // namespace
}  // namespace anatomesh
