#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "io/image_file_fixture.h"
#include "io/nifti_bytes.h"
#include "support/test_images.h"

namespace anatomesh::testing {
namespace {

/// A 2 x 2 x 2 NRRD file with raw voxels.
std::string nrrd(const std::string& type, const std::string& fields, const std::string& voxels) {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: little\n" + fields + "\n" +
         voxels;
}

/// A MetaImage of 2 x 2 x 2 8-bit voxels in the same file.
std::string meta_image(const std::string& fields, const std::string& voxels) {
  return "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n" + fields +
         "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + voxels;
}

template <typename Value>
std::string raw(const std::vector<Value>& values) {
  std::string bytes(values.size() * sizeof(Value), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

class ReadImage : public ImageFileTest {
 protected:
  template <typename Value>
  void expect_kept(const std::string& type, std::int16_t nifti_type, std::vector<Value> largest) const {
    largest.resize(8);
    const std::vector<Label> expected(largest.begin(), largest.end());
    NiftiBytes nifti;
    nifti.dim = {3, 2, 2, 2, 1, 1, 1, 1};
    nifti.set_voxels(nifti_type, largest);
    EXPECT_EQ(image_in(type + ".nii", nifti.file()).image.voxels, expected) << type;
    EXPECT_EQ(image_in(type + ".nrrd", nrrd(type, "", raw(largest))).image.voxels, expected) << type;
  }
};

TEST_F(ReadImage, EveryNumberTypeIsKeptExactly) {
  expect_kept<std::uint8_t>("uint8", 2, {1, 255});
  expect_kept<std::int8_t>("int8", 256, {1, 127});
  expect_kept<std::uint16_t>("uint16", 512, {1, 65535});
  expect_kept<std::int16_t>("int16", 4, {1, 32767});
  expect_kept<std::uint32_t>("uint32", 768, {1, 16777217, 4294967295});
  expect_kept<std::int32_t>("int32", 8, {1, 16777217, 2147483647});
  expect_kept<std::uint64_t>("uint64", 1280, {1, 16777217, 4294967295});
  expect_kept<std::int64_t>("int64", 1024, {1, 16777217, 4294967295});
  expect_kept<float>("float", 16, {1, 16777216, 4294967040.0F, -0.0F});
  expect_kept<double>("double", 64, {1, 16777217, 4294967295});
}

TEST_F(ReadImage, ValuesThatAreNoLabelsAreNamedWithTheirVoxel) {
  const auto refused_values = [&](const std::string& type, const std::string& voxels) {
    return refused<InvalidInput>("image.nrrd", nrrd(type, "", voxels));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string rule = "labels must be whole numbers from 0 to 4294967295";
  EXPECT_SAYS(refused_values("int16", raw<std::int16_t>({0, 0, 0, 0, 0, 0, -3, 0})), "voxel (0, 1, 1)");
  EXPECT_SAYS(refused_values("int16", raw<std::int16_t>({0, 0, 0, 0, 0, 0, -3, 0})), "the value -3; " + rule);
  EXPECT_SAYS(refused_values("int8", raw<std::int8_t>({0, -128, 0, 0, 0, 0, 0, 0})), "the value -128; " + rule);
  EXPECT_SAYS(refused_values("int32", raw<std::int32_t>({0, 0, -1, 0, 0, 0, 0, 0})), "the value -1; " + rule);
  EXPECT_SAYS(refused_values("int64", raw<std::int64_t>({0, 0, 4294967296, 0, 0, 0, 0, 0})), "4294967296; " + rule);
  EXPECT_SAYS(refused_values("float", raw<float>({0, 0, 0, 1.5F, 0, 0, 0, 0})), "the value 1.5; " + rule);
  EXPECT_SAYS(refused_values("float", raw<float>({0, 0, 0, 4294967296.0F, 0, 0, 0, 0})), rule);
  EXPECT_SAYS(refused_values("double", raw<double>({0, 0, 0, nan, 0, 0, 0, 0})), "the value nan; " + rule);
  EXPECT_SAYS(refused_values("double", raw<double>({0, 0, 0, -0.25, 0, 0, 0, 0})), "the value -0.25; " + rule);
}

/// Geometry survives to this tolerance: NIfTI keeps 32-bit floats, MetaImage and MINC few digits.
struct Format {
  const char* extension;
  double tolerance;
};

void expect_same(const LabelImage& actual, const LabelImage& expected, double tolerance) {
  EXPECT_EQ(actual.size, expected.size);
  EXPECT_EQ(actual.voxels, expected.voxels);
  expect_near(actual.spacing_mm, expected.spacing_mm, tolerance);
  expect_near(actual.origin_mm, expected.origin_mm, 100 * tolerance);
  expect_near(actual.direction, expected.direction, tolerance);
}

TEST_F(ReadImage, RoundTripsInEveryFormat) {
  const LabelImage shape = nested_spheres();
  const std::vector<NamedImage> images = {{"plain", shape},
                                          {"anisotropic", anisotropic(shape)},
                                          {"oblique", oblique(anisotropic(shape))},
                                          {"left_handed", left_handed(oblique(anisotropic(shape)))},
                                          {"one_voxel", only_one_voxel()}};
  for (const Format format : {Format{".nii", 1e-6}, Format{".nii.gz", 1e-6}, Format{".nrrd", 1e-12},
                              Format{".mha", 1e-6}, Format{".mnc", 1e-6}}) {
    for (const NamedImage& image : images) {
      SCOPED_TRACE(image.name + format.extension);
      const auto file = in_folder(image.name + format.extension);
      write_label_image(file, image.image);
      expect_same(read_label_image(file).image, image.image, format.tolerance);
    }
  }
}

TEST_F(ReadImage, VoxelsInAFileOfTheirOwn) {
  const std::string voxels = raw<std::uint8_t>({0, 1, 2, 3, 4, 5, 6, 7});
  const std::vector<Label> expected = {0, 1, 2, 3, 4, 5, 6, 7};
  put("voxels.raw", voxels);
  const std::string meta =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = voxels.raw\n";
  EXPECT_EQ(image_in("image.mhd", meta).image.voxels, expected);
  EXPECT_EQ(image_in("image.nhdr", nrrd("uint8", "data file: voxels.raw", "")).image.voxels, expected);
}

TEST_F(ReadImage, SpacingMustBePositive) {
  for (const char* spacing : {"0", "-1", "nan"}) {
    const std::string s = spacing;
    EXPECT_SAYS(refused<Error>("image.mha", meta_image("ElementSpacing = 1 " + s + " 1\n", std::string(8, '\1'))),
                "spac");
    EXPECT_SAYS(refused<Error>("image.nrrd", nrrd("uint8", "spacings: 1 " + s + " 1\n", std::string(8, '\1'))), "spac");
  }
}

TEST_F(ReadImage, DirectionMustBeARotation) {
  const std::string sheared = "TransformMatrix = 1 0 0 0.3 1 0 0 0 1\n";
  EXPECT_SAYS(refused<InvalidInput>("image.mha", meta_image(sheared, std::string(8, '\1'))), "not a rotation");
  const std::string sheared_nrrd =
      "space: left-posterior-superior\nspace directions: (1,0,0) (0.3,1,0) (0,0,1)\nspace origin: (0,0,0)\n";
  EXPECT_SAYS(refused<InvalidInput>("image.nrrd", nrrd("uint8", sheared_nrrd, std::string(8, '\1'))), "not a rotation");
}

TEST_F(ReadImage, VectorVoxelsAreRefused) {
  const std::string rgb =
      "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain domain\n"
      "encoding: raw\n\n" +
      std::string(24, '\1');
  EXPECT_SAYS(refused<InvalidInput>("image.nrrd", rgb), "one label a voxel");
  EXPECT_SAYS(refused<InvalidInput>("image.mha", meta_image("ElementNumberOfChannels = 2\n", std::string(16, '\1'))),
              "one label a voxel");
}

TEST_F(ReadImage, FlatImagesAreRefused) {
  const std::string flat = "NRRD0004\ntype: uint8\ndimension: 2\nsizes: 4 2\nencoding: raw\n\n" + std::string(8, '\1');
  EXPECT_SAYS(refused<InvalidInput>("image.nrrd", flat), "2D");
}

TEST_F(ReadImage, MissingAndUnusableFiles) {
  const auto missing = in_folder("missing.nii.gz");
  EXPECT_SAYS(message_of<IoError>(missing, [&] { read_label_image(missing); }), "there is no file");
  EXPECT_SAYS(refused<IoError>("image.nii.gz", ""), "empty");
  EXPECT_SAYS(refused<InvalidInput>("notes.txt", "not an image"), "known format");
  for (const char* name :
       {"image.nii", "image.nii.gz", "image.nrrd", "image.mha", "image.mnc", "image.hdr", "image.dcm"}) {
    refused<IoError>(name, "no such thing as an image, but more than 348 bytes" + std::string(1000, '.'));
  }
}

TEST_F(ReadImage, TruncatedFilesAreRefused) {
  const LabelImage image = noise(7, 16, 200);
  for (const char* extension : {".nii", ".nii.gz", ".nrrd", ".mha", ".mnc"}) {
    const auto whole = in_folder(std::string("whole") + extension);
    write_label_image(whole, image);
    const std::string bytes = bytes_of(whole);
    for (const double share : {0.02, 0.3, 0.5, 0.9, 0.99}) {
      const auto length = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
      refused<IoError>(std::string("cut") + extension, bytes.substr(0, length));
    }
  }
  const auto raw_nrrd = nrrd("uint8", "", std::string(7, '\1'));
  refused<IoError>("image.nrrd", raw_nrrd);
  refused<IoError>("image.mha", meta_image("", std::string(7, '\1')));
}

TEST_F(ReadImage, DamagedCompressionIsRefused) {
  for (const std::string name : {"image.nii.gz", "image.nrrd", "image.mha"}) {
    write_label_image(in_folder(name), noise(7, 16, 200));
    const std::string bytes = bytes_of(in_folder(name));
    for (std::size_t at = 600; at < bytes.size(); at += 97) {  // beyond the headers
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(~damaged[at]);
      refused<IoError>(name, damaged);
    }
  }
}

TEST_F(ReadImage, MissingVoxelFileIsRefused) {
  const std::string header =
      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
      "ElementDataFile = gone.raw\n";
  refused<IoError>("image.mhd", header);
  put("gone.raw", std::string(7, '\1'));
  refused<IoError>("image.mhd", header);
}

}  // namespace
}  // namespace anatomesh::testing
