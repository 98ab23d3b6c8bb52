// DICOM segmentation objects made byte by byte.
#include <array>
#include <vector>

#include "io/dicom_bytes.h"
#include "io/image_file_fixture.h"

namespace anatomesh::testing {
namespace {

constexpr const char* kClass = "1.2.840.10008.5.1.4.1.1.66.4";

std::string sequence(std::uint16_t group, std::uint16_t tag, const std::vector<std::string>& items, bool open = false) {
  const auto length_of = [&](const std::string& bytes) {
    return open ? std::string(4, '\xff') : dicom_u32(bytes.size());
  };
  const std::string item_end = open ? dicom_u16(0xFFFE) + dicom_u16(0xE00D) + dicom_u32(0) : "";
  const std::string all_end = open ? dicom_u16(0xFFFE) + dicom_u16(0xE0DD) + dicom_u32(0) : "";
  std::string content;
  for (const std::string& item : items)
    content += dicom_u16(0xFFFE) + dicom_u16(0xE000) + length_of(item) + item + item_end;
  return dicom_u16(group) + dicom_u16(tag) + "SQ" + dicom_u16(0) + length_of(content) + content + all_end;
}

/// A frame: 3 x 2 voxels of a segment at a position.
struct Frame {
  std::size_t segment = 1;
  std::string position = "5\\6\\7";
  std::array<int, 6> voxels = {};
};

/// A file with two segments.
struct Segmentation {
  std::vector<Frame> frames = {{}};
  std::string orientation = "1\\0\\0\\0\\1\\0";
  std::string distance = "3";  ///< empty: none
  std::string kind = "BINARY";
  std::string syntax = "1.2.840.10008.1.2.1";
  bool open = false;        ///< sequences without their lengths
  std::size_t missing = 0;  ///< bytes of voxels
  std::string frame_count = {};

  std::string groups(const Frame& frame) const {
    return sequence(0x20, 0x9113, {dicom_element(0x20, 0x32, "DS", frame.position)}, open) +
           sequence(0x62, 0xA, {dicom_element(0x62, 0xB, "US", dicom_u16(frame.segment))}, open);
  }

  std::string shared() const {
    std::string measures = dicom_element(0x18, 0x50, "DS", "2.5");
    if (!distance.empty()) measures += dicom_element(0x18, 0x88, "DS", distance);
    measures += dicom_element(0x28, 0x30, "DS", "2\\1");
    return sequence(0x20, 0x9116, {dicom_element(0x20, 0x37, "DS", orientation)}, open) +
           sequence(0x28, 0x9110, {measures}, open);
  }

  std::string pixels() const {
    std::string bytes((frames.size() * 6 + 7) / 8, '\0');
    for (std::size_t n = 0; n < frames.size() * 6; ++n) {
      if (frames[n / 6].voxels[n % 6] != 0) bytes[n / 8] = static_cast<char>(bytes[n / 8] | 1 << n % 8);
    }
    bytes.resize(bytes.size() - missing);
    return bytes.size() % 2 == 0 ? bytes : bytes + '\0';
  }

  std::string file() const {
    const std::string meta = dicom_element(2, 2, "UI", kClass) + dicom_element(2, 0x10, "UI", syntax);
    std::vector<std::string> per_frame;
    for (const Frame& frame : frames) per_frame.push_back(groups(frame));
    const auto segment = [](std::size_t number, const std::string& name) {
      return dicom_element(0x62, 4, "US", dicom_u16(number)) + dicom_element(0x62, 5, "LO", name);
    };
    const std::string count = frame_count.empty() ? std::to_string(frames.size()) : frame_count;
    return std::string(128, '\0') + "DICM" + dicom_element(2, 0, "UL", dicom_u32(meta.size())) + meta +
           dicom_element(8, 0x16, "UI", kClass) + dicom_element(8, 0x60, "CS", "SEG") +
           dicom_element(0x28, 8, "IS", count) + dicom_element(0x28, 0x10, "US", dicom_u16(2)) +
           dicom_element(0x28, 0x11, "US", dicom_u16(3)) + dicom_element(0x28, 0x100, "US", dicom_u16(1)) +
           dicom_element(0x62, 1, "CS", kind) + sequence(0x62, 2, {segment(1, "Leber"), segment(2, "a tumour")}, open) +
           sequence(0x5200, 0x9229, {shared()}, open) + sequence(0x5200, 0x9230, per_frame, open) +
           long_dicom_element(0x7FE0, 0x10, "OB", pixels());
  }
};

class ReadDicomSegmentation : public MadeImageTest<Segmentation> {
 protected:
  ReadDicomSegmentation() : MadeImageTest("a.dcm") {}
};

using Labels = std::vector<Label>;

TEST_F(ReadDicomSegmentation, FramesOfAnyOrderBecomeOneImage) {
  for (const bool open : {false, true}) {
    const ImageFile file = read({.frames = {{1, "5\\6\\13", {1, 1, 1, 0, 0, 0}},
                                            {2, "5\\6\\7", {0, 0, 0, 0, 1, 0}},
                                            {1, "5\\6\\7", {1, 0, 0, 0, 1, 1}},
                                            {2, "5\\6\\13", {0, 0, 0, 1, 0, 0}}},
                                 .open = open});
    EXPECT_EQ(file.image.size, (std::array<std::size_t, 3>{3, 2, 3}));
    EXPECT_EQ(file.image.voxels, (Labels{1, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 0, 0}));
    EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 2, 3}));
    EXPECT_EQ(file.image.origin_mm, (Vec3{5, 6, 7}));
    EXPECT_EQ(file.image.names, (LabelTable{{1, {"Leber", {}}}, {2, {"a tumour", {}}}}));
    EXPECT_SAYS(only_note(file), "1 voxels");
  }
}

TEST_F(ReadDicomSegmentation, ObliqueStacksAlongTheirNormal) {
  // Rows run along (0.6, 0.8, 0), columns along (0, 0, -1); the normal is (-0.8, 0.6, 0).
  const ImageFile file = read({.frames = {{1, "0\\0\\0", {1}}, {1, "-1.6\\1.2\\0", {1}}},
                               .orientation = "0.6\\0.8\\0\\0\\0\\-1",
                               .distance = ""});
  EXPECT_EQ(file.image.size[2], 2U);
  expect_near(file.image.direction, {{{0.6, 0, -0.8}, {0.8, 0, 0.6}, {0, -1, 0}}}, 1e-12);
  EXPECT_NEAR(file.image.spacing_mm.z, 2, 1e-12);
}

TEST_F(ReadDicomSegmentation, OneFrameHasTheThicknessOfItsSlice) {
  EXPECT_EQ(read({.distance = ""}).image.spacing_mm, (Vec3{1, 2, 2.5}));
}

TEST_F(ReadDicomSegmentation, WhatIsWrongIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>({.kind = "FRACTIONAL"}), "FRACTIONAL");
  EXPECT_SAYS(refused<InvalidInput>({.syntax = "1.2.840.10008.1.2.2"}), "1.2.840.10008.1.2.2");
  EXPECT_SAYS(refused<InvalidInput>({.frames = {{}, {1, "5\\6\\8", {}}}}), "frame 2");
  EXPECT_SAYS(refused<InvalidInput>({.frames = {{}, {1, "5.5\\6\\10", {}}}}), "frame 2");
  EXPECT_SAYS(refused<InvalidInput>({.frames = {{}, {1, "5\\6\\9e9", {}}}}), "frame 2");
  EXPECT_SAYS(refused<InvalidInput>({.orientation = "1\\0\\0\\1\\0\\0"}), "direction");
  EXPECT_SAYS(refused<InvalidInput>({.distance = "0"}), "spacing");
  EXPECT_SAYS(refused<InvalidInput>({.distance = "nan"}), "spacing");
  EXPECT_SAYS(refused<IoError>({.orientation = "1\\0\\0\\0\\1"}), "ImageOrientationPatient");
  EXPECT_SAYS(refused<IoError>({.frames = {{3, "5\\6\\7", {}}}}), "segment 3");
  EXPECT_SAYS(refused<IoError>({.frames = {{1, "5\\six\\7", {}}}}), "ImagePositionPatient");
  EXPECT_SAYS(refused<IoError>({.frames = {}}), "PerFrameFunctionalGroupsSequence");
  EXPECT_SAYS(refused<IoError>({.frame_count = "7"}), "NumberOfFrames");
  EXPECT_SAYS(refused<IoError>({.frames = std::vector<Frame>(9), .missing = 3}), "4 of the 7 bytes");
}

TEST_F(ReadDicomSegmentation, AFolderIsToldToNameTheFile) {
  put("a.dcm", Segmentation().file());
  const auto folder = in_folder("");
  try {
    read_label_image(folder);
    ADD_FAILURE();
  } catch (const InvalidInput& error) {
    EXPECT_SAYS(std::string(error.what()), "name a binary one itself");
  }
}

TEST_F(ReadDicomSegmentation, NoBytesCrashIt) {
  const std::string good =
      Segmentation{.frames = {{1, "5\\6\\7", {1, 0, 1}}, {2, "5\\6\\10", {}}}, .open = true}.file();
  const auto attempt = [&](const std::string& bytes) {
    try {
      read_label_image(put("a.dcm", bytes));
    } catch (const Error&) {
    }
  };
  const std::size_t first = good.find("SEG");  // what comes before says that it is such a file at all
  for (std::size_t left = first; left < good.size(); left += 7) attempt(good.substr(0, left));
  for (std::size_t at = first; at < good.size(); at += 5) {
    for (const char c : {'\0', '\xff', '9'}) {
      std::string changed = good;
      changed[at] = c;
      attempt(changed);
    }
  }
}

}  // namespace
}  // namespace anatomesh::testing
