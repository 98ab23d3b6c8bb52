#include "image/boundary_area.h"

#include <gtest/gtest.h>

#include "support/test_images.h"

namespace anatomesh {
namespace {

TEST(BoundaryAreas, CountEachInterfaceForBothTissues) {
  // Two cubes of 10 x 10 x 10 voxels that share a face.
  const std::vector<double> areas = boundary_areas_mm2(make_tissue_image(testing::two_touching_cubes()));
  ASSERT_EQ(areas.size(), 3u);
  EXPECT_DOUBLE_EQ(areas[1], 600);
  EXPECT_DOUBLE_EQ(areas[2], 600);
  EXPECT_DOUBLE_EQ(areas[0], 1000);
}

TEST(BoundaryAreas, AreInSquareMillimetres) {
  LabelImage image = testing::only_one_voxel();
  image.spacing_mm = {2, 3, 5};
  const std::vector<double> areas = boundary_areas_mm2(make_tissue_image(image));
  EXPECT_DOUBLE_EQ(areas[1], 2 * (6 + 10 + 15));
}

TEST(BoundaryAreas, TheBorderOfTheImageIsBoundary) {
  const std::vector<double> areas = boundary_areas_mm2(make_tissue_image(testing::no_background_box()));
  EXPECT_GT(areas[0], 0);
  EXPECT_GT(areas[1], 0);
}

}  // namespace
}  // namespace anatomesh
