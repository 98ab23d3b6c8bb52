#include <algorithm>
#include <filesystem>
#include <vector>

#include "io/image_file_fixture.h"
#include "support/test_images.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

class ReadMasks : public IoTest {
 protected:
  /// A mask of the voxels n of the image, as a file.
  fs::path mask(const std::string& name, const std::vector<std::size_t>& voxels, Label value = 1) {
    LabelImage image = grid_;
    for (const std::size_t n : voxels) image.voxels[n] = value;
    write_label_image(in_folder(name), image);
    return in_folder(name);
  }

  LabelImage grid_ = {
      .size = {3, 2, 2}, .spacing_mm = {1, 2, 3}, .origin_mm = {5, 6, 7}, .voxels = std::vector<Label>(12)};
};

std::string refused(const std::vector<fs::path>& paths) {
  return message_of<InvalidInput>(paths.back(), [&] { read_label_masks(paths); });
}

TEST_F(ReadMasks, AreLabelledInTheirOrder) {
  const ImageFile file = read_label_masks({mask("liver.nii.gz", {0, 1, 2, 3}, 255), mask("vessels.nrrd", {2, 5}, 7),
                                           mask("tumour.v2.mha", {3, 5, 6}), mask("rest.seg.nrrd", {11})});
  EXPECT_EQ(file.image.voxels, (std::vector<Label>{1, 1, 2, 3, 0, 3, 3, 0, 0, 0, 0, 4}));
  EXPECT_EQ(file.image.names,
            (LabelTable{{1, {"liver", {}}}, {2, {"vessels", {}}}, {3, {"tumour.v2", {}}}, {4, {"rest", {}}}}));
  EXPECT_EQ(file.image.spacing_mm, grid_.spacing_mm);
  EXPECT_EQ(file.image.origin_mm, grid_.origin_mm);
  EXPECT_SAYS(only_note(file), "3 voxels");
}

TEST_F(ReadMasks, ObliqueAndLeftHandedGridsStayTheirs) {
  for (const LabelImage& image : {oblique(grid_), left_handed(grid_)}) {
    grid_ = image;
    const ImageFile file = read_label_masks({mask("a.nrrd", {0}), mask("b.nii.gz", {1})});
    EXPECT_EQ(file.image.voxels[1], 2U);
    expect_near(file.image.direction, image.direction, 1e-6);
  }
}

TEST_F(ReadMasks, AnEmptyMaskIsTold) {
  const ImageFile file = read_label_masks({mask("a.nrrd", {0}), mask("b.nrrd", {})});
  EXPECT_SAYS(only_note(file), "b.nrrd");
  EXPECT_SAYS(only_note(file), "labelled 2");
}

TEST_F(ReadMasks, OneIsEnoughNoneIsNot) {
  EXPECT_EQ(read_label_masks({mask("a.nrrd", {4}, 9)}).image.voxels[4], 1U);
  EXPECT_THROW(read_label_masks({}), InvalidInput);
}

TEST_F(ReadMasks, GridsThatDifferAreNamed) {
  const fs::path first = mask("a.nrrd", {0});
  const LabelImage grid = grid_;
  const auto said_of = [&](const auto& change) {
    grid_ = grid;
    change(grid_);
    const std::string said = refused({first, mask("b.nrrd", {1})});
    EXPECT_SAYS(said, "a.nrrd");
    return said;
  };
  const std::string size = said_of([](LabelImage& g) { g.size = {2, 3, 2}; });
  EXPECT_SAYS(size, "3 x 2 x 2");
  EXPECT_SAYS(size, "2 x 3 x 2");
  EXPECT_SAYS(said_of([](LabelImage& g) { g.spacing_mm.y = 2.5; }), "spacing 1, 2.5, 3");
  EXPECT_SAYS(said_of([](LabelImage& g) { g.origin_mm.z = 7.5; }), "origin 5, 6, 7.5");
  EXPECT_SAYS(said_of([](LabelImage& g) { g.direction[2][2] = -1; }), "direction");
  EXPECT_SAYS(said_of([](LabelImage& g) { g = oblique(g); }), "grid");
}

TEST_F(ReadMasks, RoundingIsNoDifference) {
  const fs::path first = mask("a.nrrd", {0});
  grid_.origin_mm.x += 1e-5;
  EXPECT_EQ(read_label_masks({first, mask("b.nrrd", {1})}).image.voxels[1], 2U);
}

TEST_F(ReadMasks, LabelImagesAreNoMasks) {
  LabelImage image = grid_;
  image.voxels[3] = 4;
  image.voxels[4] = 6;
  write_label_image(in_folder("labels.nrrd"), image);
  EXPECT_SAYS(refused({mask("a.nrrd", {0}), in_folder("labels.nrrd")}), "values 4 and 6");
}

}  // namespace
}  // namespace anatomesh::testing
