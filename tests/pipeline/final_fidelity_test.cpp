#include "pipeline/final_fidelity.h"

#include <gtest/gtest.h>

#include "support/test_images.h"

namespace anatomesh {
namespace {

/// A mesh without tetrahedra that would hold each voxel as `tissue_in_mesh` says.
MeshFidelity reached_with(const TissueImage& image, const std::vector<TissueId>& tissue_in_mesh) {
  MeshFidelity reached;
  reached.tissue_in_mesh = tissue_in_mesh;
  reached.tissues.resize(image.labels.size());
  for (std::size_t v = 0; v < tissue_in_mesh.size(); ++v) {
    const TissueId asked = image.voxels[v], got = tissue_in_mesh[v];
    ++reached.tissues[asked].voxels;
    ++reached.tissues[got].in_tets;
    reached.tissues[got].hits += asked == got;
  }
  return reached;
}

/// A box with a cavity of 3 x 3 x 3 voxels.
LabelImage box_with_cavity() {
  const auto is_cavity = [](int n) { return n >= 7 && n < 10; };
  return testing::make_image(
      {17, 17, 17}, [&](int i, int j, int k) { return is_cavity(i) && is_cavity(j) && is_cavity(k) ? 0u : 5u; });
}

TEST(FarVoxels, AFilledCavityIsMissedAltogether) {
  const TissueImage image = make_tissue_image(box_with_cavity());
  std::vector<TissueId> filled = image.voxels;
  const std::size_t middle = image.offset(image.size[0] / 2, image.size[1] / 2, image.size[2] / 2);
  ASSERT_EQ(filled[middle], 0);
  for (int k = 5; k < image.size[2] - 5; ++k) {
    for (int j = 5; j < image.size[1] - 5; ++j) {
      for (int i = 5; i < image.size[0] - 5; ++i) filled[image.offset(i, j, k)] = 1;
    }
  }
  const MeshFidelity reached = reached_with(image, filled);
  ASSERT_LT(reached.tissues[1].f1(), 1);
  const FarVoxels far = find_far_voxels(reached, image, {0, 1});
  EXPECT_EQ(far.voxels.size(), 27u);
  EXPECT_EQ(far.of_tissue[1], 27u);
  EXPECT_EQ(far.others[1].f1(), 1);
  EXPECT_TRUE(find_far_voxels(reached, image, {0, 0}).voxels.empty()) << "the tissue is not judged";
}

TEST(FarVoxels, ALayerAtTheBoundaryIsNot) {
  const TissueImage image = make_tissue_image(testing::sphere());
  std::vector<TissueId> grown = image.voxels;
  for (int k = 1; k < image.size[2] - 1; ++k) {
    for (int j = 1; j < image.size[1] - 1; ++j) {
      for (int i = 1; i < image.size[0] - 1; ++i) {
        if (image.at(i - 1, j, k) == 1) grown[image.offset(i, j, k)] = 1;
      }
    }
  }
  const MeshFidelity reached = reached_with(image, grown);
  ASSERT_LT(reached.tissues[1].f1(), 1);
  EXPECT_TRUE(find_far_voxels(reached, image, {0, 1}).voxels.empty());
}

TEST(FarVoxels, NothingIsWhereAllIsRight) {
  const TissueImage image = make_tissue_image(testing::nested_spheres());
  EXPECT_TRUE(find_far_voxels(reached_with(image, image.voxels), image, {0, 1, 1, 1}).voxels.empty());
}

}  // namespace
}  // namespace anatomesh
