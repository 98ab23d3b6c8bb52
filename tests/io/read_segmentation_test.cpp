// Segmentations of 3D Slicer, written byte by byte as Slicer does.
#include <initializer_list>
#include <sstream>
#include <utility>
#include <vector>

#include "io/image_file_fixture.h"

namespace anatomesh::testing {
namespace {

/// A .seg.nrrd of 3 x 2 x 2 voxels and any number of layers.
struct SegNrrd {
  std::size_t layers = 1;
  bool has_list = false;  ///< an axis for the layers, as there always is for more than one
  std::string directions = "(1,0,0) (0,2,0) (0,0,3)";
  std::string keys = {};
  std::string voxels = std::string(12, '\0');  ///< layers side by side
  std::string type = "unsigned char";

  std::string file() const {
    const bool four = has_list || layers > 1;
    std::ostringstream text;
    text << "NRRD0004\n# Complete NRRD file format specification at:\n# http://teem.sourceforge.net/nrrd/format.html\n"
         << "type: " << type << "\ndimension: " << (four ? 4 : 3)
         << "\nspace: left-posterior-superior\nsizes: " << (four ? std::to_string(layers) + " " : "")
         << "3 2 2\nspace directions: " << (four ? "none " : "") << directions << "\nkinds: " << (four ? "list " : "")
         << "domain domain domain\n"
         << "endian: little\nencoding: raw\nspace origin: (-10,20,30)\n"
         << keys << "Segmentation_MasterRepresentation:=Binary labelmap\n\n"
         << voxels;
    return text.str();
  }
};

std::string segment(int n, const std::string& name, int value, int layer, const std::string& colour = "1 0.5 0") {
  const std::string prefix = "Segment" + std::to_string(n) + "_";
  return prefix + "Color:=" + colour + "\n" + prefix + "Extent:=0 2 0 1 0 1\n" + prefix + "ID:=Segment_" +
         std::to_string(n + 1) + "\n" + prefix + "LabelValue:=" + std::to_string(value) + "\n" + prefix +
         "Layer:=" + std::to_string(layer) + "\n" + prefix + "Name:=" + name + "\n" + prefix +
         "Tags:=Segmentation.Status:inprogress|\n";
}

/// Two layers: the values of a voxel in each of them, from the first voxel on; 0 is the rest.
SegNrrd two_layers(std::string keys, std::initializer_list<std::pair<char, char>> voxels = {}) {
  SegNrrd nrrd = {.layers = 2, .keys = std::move(keys), .voxels = {}};
  for (const auto& [first, second] : voxels) nrrd.voxels += {first, second};
  nrrd.voxels.resize(24);
  return nrrd;
}

class ReadSegmentation : public MadeImageTest<SegNrrd> {
 protected:
  ReadSegmentation() : MadeImageTest("a.seg.nrrd") {}
};

using Labels = std::vector<Label>;

TEST_F(ReadSegmentation, OneLayerHasNamesAndColours) {
  for (const bool has_list : {false, true}) {
    const ImageFile file = read({.has_list = has_list,
                                 .keys = segment(0, "left kidney", 1, 0) + segment(1, "Große Vene", 7, 0, "0 1 0.25"),
                                 .voxels = std::string("\1\0\7\0\0\0\0\0\0\0\1\7", 12)});
    EXPECT_EQ(file.image.voxels, (Labels{1, 0, 7, 0, 0, 0, 0, 0, 0, 0, 1, 7}));
    EXPECT_EQ(file.image.names,
              (LabelTable{{1, {"left kidney", Colour{255, 128, 0}}}, {7, {"Große Vene", Colour{0, 255, 64}}}}));
    EXPECT_TRUE(file.notes.empty());
    EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 2, 3}));
    EXPECT_EQ(file.image.origin_mm, (Vec3{-10, 20, 30}));
  }
}

TEST_F(ReadSegmentation, AValueWithoutASegmentStaysALabelInOneLayer) {
  const ImageFile file = read({.keys = segment(0, "kidney", 1, 0), .voxels = std::string(12, '\5')});
  EXPECT_EQ(file.image.voxels, Labels(12, 5));
  EXPECT_EQ(file.image.names.size(), 1U);
}

TEST_F(ReadSegmentation, LaterSegmentsWinWhereLayersOverlap) {
  // Segment 1 lies in layer 0 and comes after segment 0 of layer 1; segment 2 comes last.
  const std::string keys = segment(0, "vessel", 4, 1) + segment(1, "liver", 2, 0) + segment(2, "tumour", 9, 1);
  const ImageFile file = read(two_layers(
      keys, {{2, 0}, {2, 4}, {2, 9}, {0, 4}, {0, 9}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {2, 0}}));
  EXPECT_EQ(file.image.voxels, (Labels{2, 2, 9, 4, 9, 0, 0, 0, 0, 0, 0, 2}));
  EXPECT_EQ(file.image.names.at(9).name, "tumour");
  EXPECT_SAYS(only_note(file), "2 voxels");
  EXPECT_SAYS(only_note(file), "a.seg.nrrd");
}

TEST_F(ReadSegmentation, EqualValuesAreNumbered) {
  const std::string keys = segment(0, "liver", 1, 0) + segment(1, "vessel", 1, 1) + segment(2, "tumour", 2, 0);
  const ImageFile file = read(two_layers(
      keys, {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}, {2, 1}}));
  EXPECT_EQ(file.image.voxels, (Labels{1, 2, 3, 2, 0, 0, 0, 0, 0, 0, 0, 3}));
  EXPECT_EQ(file.image.names.at(2).name, "vessel");
  ASSERT_EQ(file.notes.size(), 2U);
  EXPECT_SAYS(file.notes[0], "labelled 1 to 3");
  EXPECT_SAYS(file.notes[1], "2 voxels");
}

TEST_F(ReadSegmentation, OldFilesHaveALayerASegment) {
  const std::string keys =
      "Segment0_ID:=a\nSegment0_Name:=liver\nSegment1_ID:=b\nSegment1_Name:=\nSegment1_Color:=red\n";
  const ImageFile file = read(two_layers(keys, {{1, 0}, {0, 1}, {1, 1}}));
  EXPECT_EQ(file.image.voxels, (Labels{1, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(file.image.names, (LabelTable{{1, {"liver", {}}}, {2, {"b", {}}}}));
}

TEST_F(ReadSegmentation, ValuesOfNoSegmentAreTold) {
  const ImageFile file = read(two_layers(segment(0, "a", 1, 0) + segment(1, "b", 2, 1), {{1, 0}, {0, 5}, {3, 1}}));
  EXPECT_EQ(file.image.voxels, (Labels{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_SAYS(only_note(file), "2 voxels");
  EXPECT_SAYS(only_note(file), "no segment");
}

TEST_F(ReadSegmentation, ObliqueAndLeftHandedLayersLieWhereTheFileSays) {
  const std::string oblique = "(0.6,0.8,0) (-1.6,1.2,0) (0,0,-3)";
  for (const std::size_t layers : {std::size_t{1}, std::size_t{2}}) {
    const ImageFile file = read({.layers = layers,
                                 .directions = oblique,
                                 .keys = segment(0, "a", 1, 0),
                                 .voxels = std::string(12 * layers, '\1')});
    expect_near(file.image.direction, {{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, -1}}}, 1e-12);
    EXPECT_NEAR(file.image.spacing_mm.y, 2, 1e-12);
    EXPECT_EQ(file.image.origin_mm, (Vec3{-10, 20, 30}));
  }
}

TEST_F(ReadSegmentation, LabelsOf16BitsInManyVoxels) {
  constexpr std::size_t kSide = 60;  // more voxels than are merged at once
  std::string voxels;
  for (std::size_t n = 0; n < kSide * kSide * kSide; ++n)
    voxels += n % 7 == 0 ? std::string("\x2c\1\0\0", 4) : std::string("\0\0\1\0", 4);
  std::string text =
      SegNrrd{.layers = 2, .keys = segment(0, "a", 300, 0) + segment(1, "b", 1, 1), .voxels = voxels, .type = "uint16"}
          .file();
  text.replace(text.find("3 2 2"), 5, "60 60 60");
  const ImageFile file = image_in("a.seg.nrrd", text);
  for (std::size_t n = 0; n < file.image.voxels.size(); ++n) ASSERT_EQ(file.image.voxels[n], n % 7 == 0 ? 300U : 1U);
}

TEST_F(ReadSegmentation, WhatIsWrongIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>(two_layers(segment(0, "a", 1, 2))), "Segment0_Layer 2");
  EXPECT_SAYS(refused<InvalidInput>(two_layers(segment(0, "a", 0, 1))), "0 is the background");
  const std::string same = refused<InvalidInput>(two_layers(segment(0, "a", 3, 1) + segment(1, "b", 3, 1)));
  EXPECT_SAYS(same, "'a' and 'b', both of value 3 in layer 1");
  for (const char* value : {"-1", "two", "", "4294967296", "1.5"}) {
    const std::string keys = std::string("Segment0_ID:=a\nSegment0_LabelValue:=").append(value).append("\n");
    EXPECT_SAYS(refused<InvalidInput>({.keys = keys}), "Segment0_LabelValue");
  }
  EXPECT_SAYS(refused<InvalidInput>(two_layers("")), "2 numbers a voxel");
  const std::string fractional("\0\0\0\x3f\0\0\0\x3f", 8);  // 0.5, 0.5
  SegNrrd floats = {.layers = 2, .keys = segment(0, "a", 1, 0), .type = "float"};
  floats.voxels = fractional + std::string(22 * 4, '\0');
  EXPECT_SAYS(refused<InvalidInput>(floats), "0.5");
}

TEST_F(ReadSegmentation, TruncatedFilesAreRefused) {
  const std::string good =
      SegNrrd{.layers = 2, .keys = segment(0, "a", 1, 0) + segment(1, "b", 1, 1), .voxels = std::string(24, '\1')}
          .file();
  for (const std::size_t left : {good.size() - 1, good.size() - 20, good.size() / 2}) {
    const auto file = put("a.seg.nrrd", good.substr(0, left));
    EXPECT_THROW(read_label_image(file), Error) << left;
  }
  std::string hostile = good;
  hostile.replace(hostile.find("2 3 2 2"), 7, "60000 60000 60000 60000");
  EXPECT_THROW(read_label_image(put("a.seg.nrrd", hostile)), Error);
}

}  // namespace
}  // namespace anatomesh::testing
