#include <cmath>
#include <cstdint>
#include <limits>

#include "io/image_file_fixture.h"
#include "io/nifti_bytes.h"

namespace anatomesh::testing {
namespace {

class ReadNifti : public MadeImageTest<NiftiBytes> {
 protected:
  ReadNifti() : MadeImageTest("image.nii") {}
};

constexpr Mat3 kRasAxes = {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}};

TEST_F(ReadNifti, AgreeingForms) {
  const ImageFile file = read({});
  EXPECT_EQ(file.image.size, (std::array<std::size_t, 3>{4, 3, 2}));
  EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 2, 3}));
  EXPECT_EQ(file.image.origin_mm, (Vec3{-10, -20, 30}));
  EXPECT_EQ(file.image.direction, kRasAxes);
  EXPECT_TRUE(file.notes.empty());
}

TEST_F(ReadNifti, SformIsUsedWhereFormsDisagree) {
  NiftiBytes nifti;
  nifti.srow = {{{0, 0, -3.5F, 1}, {1.5F, 0, 0, 2}, {0, 2.5F, 0, 3}}};  // spacings that pixdim does not have
  const ImageFile file = read(nifti);
  expect_near(file.image.spacing_mm, {1.5, 2.5, 3.5}, 1e-12);
  expect_near(file.image.origin_mm, {-1, -2, 3}, 1e-12);
  expect_near(file.image.direction, {{{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}}}, 1e-6);
  EXPECT_SAYS(only_note(file), "the sform is used");
}

TEST_F(ReadNifti, SformWithReflectionIsUsed) {
  NiftiBytes nifti;
  nifti.srow[0] = {-1, 0, 0, 13};
  const ImageFile file = read(nifti);
  expect_near(file.image.direction, {{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}, 1e-6);
  EXPECT_SAYS(only_note(file), "disagree by up to 3");
}

TEST_F(ReadNifti, QformIsUsedWhereSformCodeIsZero) {
  NiftiBytes nifti;
  nifti.sform_code = 0;
  nifti.srow[0] = {-1, 0, 0, 5};
  nifti.quatern = {0, 0, std::sqrt(0.5F)};  // a quarter turn about z
  nifti.pixdim[0] = -1;                     // and the third axis reflected
  const ImageFile file = read(nifti);
  expect_near(file.image.direction, {{{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}}, 1e-6);
  expect_near(file.image.origin_mm, {-10, -20, 30}, 1e-12);
  EXPECT_TRUE(file.notes.empty());
}

TEST_F(ReadNifti, QformIsUsedWhereSformIsSheared) {
  NiftiBytes nifti;
  nifti.srow[0][1] = 0.5F;
  const ImageFile file = read(nifti);
  EXPECT_EQ(file.image.direction, kRasAxes);
  EXPECT_SAYS(only_note(file), "the qform is used");
}

TEST_F(ReadNifti, ShearedSformAloneIsRefused) {
  NiftiBytes nifti;
  nifti.qform_code = 0;
  nifti.srow[0][1] = 0.5F;
  EXPECT_SAYS(refused<InvalidInput>(nifti), "not a rotation");
  nifti.srow = {};
  EXPECT_SAYS(refused<InvalidInput>(nifti), "spacing");
  nifti.srow[0][0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_SAYS(refused<InvalidInput>(nifti), "nan");
}

TEST_F(ReadNifti, SmallDeviationIsMadeOrthonormal) {
  NiftiBytes nifti;
  nifti.qform_code = 0;
  nifti.srow[0][1] = 5e-5F;
  const Mat3 m = read(nifti).image.direction;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      const double product = m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b];
      EXPECT_NEAR(product, a == b ? 1 : 0, 1e-12);
    }
  }
}

TEST_F(ReadNifti, NoFormIsNoted) {
  NiftiBytes nifti;
  nifti.qform_code = nifti.sform_code = 0;
  const ImageFile file = read(nifti);
  EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 2, 3}));
  EXPECT_SAYS(only_note(file), "does not say where it lies");
}

TEST_F(ReadNifti, UnitsAreConverted) {
  struct Case {
    char xyzt_units;
    double mm;
  };
  for (const Case c : {Case{0, 1}, Case{1, 1000}, Case{2 + 8, 1}, Case{3, 0.001}}) {
    for (const std::int16_t sform_code : {std::int16_t{1}, std::int16_t{0}}) {
      NiftiBytes nifti;
      nifti.xyzt_units = c.xyzt_units;
      nifti.sform_code = sform_code;
      const ImageFile file = read(nifti);
      expect_near(file.image.spacing_mm, {1 * c.mm, 2 * c.mm, 3 * c.mm}, 1e-12 * c.mm);
      expect_near(file.image.origin_mm, {-10 * c.mm, -20 * c.mm, 30 * c.mm}, 1e-12 * c.mm);
      EXPECT_EQ(file.notes.size(), c.mm == 1 ? 0U : 1U);
    }
  }
}

TEST_F(ReadNifti, OtherByteOrder) {
  NiftiBytes nifti;
  nifti.srow[0] = {-1, 0, 0, 13};
  nifti.voxels[5] = 7;
  const ImageFile file = image_in("image.nii", nifti.header(true) + std::string(4, '\0') + nifti.voxels);
  EXPECT_EQ(file.image.voxels[5], 7U);
  EXPECT_EQ(file.image.origin_mm, (Vec3{-13, -20, 30}));
}

TEST_F(ReadNifti, HeaderAndVoxelsInTwoFiles) {
  NiftiBytes nifti;
  nifti.magic = std::string("ni1\0", 4);
  nifti.voxels[5] = 7;
  std::string header = nifti.header();
  std::fill_n(header.begin() + 108, 4, '\0');  // the voxels start at 0
  put("image.hdr", header);
  put("image.img", nifti.voxels);
  for (const char* name : {"image.hdr", "image.img"}) {
    const ImageFile file = read_label_image(in_folder(name));
    EXPECT_EQ(file.image.voxels[5], 7U);
    EXPECT_EQ(file.image.origin_mm, (Vec3{-10, -20, 30}));
  }
}

TEST_F(ReadNifti, Analyze) {
  NiftiBytes nifti;
  nifti.magic = std::string(4, '\0');
  nifti.qform_code = nifti.sform_code = 0;
  nifti.voxels[5] = 7;
  std::string header = nifti.header();
  std::fill(header.begin() + 108, header.end(), '\0');
  put("image.hdr", header);
  put("image.img", nifti.voxels);
  const ImageFile file = read_label_image(in_folder("image.hdr"));
  EXPECT_EQ(file.image.size, (std::array<std::size_t, 3>{4, 3, 2}));
  EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 2, 3}));
  EXPECT_EQ(file.image.voxels[5], 7U);
  EXPECT_SAYS(only_note(file), "Analyze");
}

TEST_F(ReadNifti, TrailingDimensionsOfOneAreDropped) {
  NiftiBytes nifti;
  nifti.dim = {5, 4, 3, 2, 1, 1, 1, 1};
  EXPECT_EQ(read(nifti).image.voxels.size(), 24U);
}

TEST_F(ReadNifti, OtherDimensionsAreRefused) {
  NiftiBytes nifti;
  nifti.dim = {2, 6, 4, 1, 1, 1, 1, 1};
  EXPECT_SAYS(refused<InvalidInput>(nifti), "2D");
  nifti.dim = {4, 4, 3, 1, 2, 1, 1, 1};
  EXPECT_SAYS(refused<InvalidInput>(nifti), "4D");
}

TEST_F(ReadNifti, VectorVoxelsAreRefused) {
  NiftiBytes rgb;
  rgb.datatype = 128;
  rgb.bitpix = 24;
  rgb.voxels.assign(24 * 3, '\1');
  EXPECT_SAYS(refused<InvalidInput>(rgb), "one label a voxel");
  NiftiBytes vectors;
  vectors.dim = {5, 4, 3, 1, 1, 2, 1, 1};
  vectors.intent_code = 1007;
  refused<InvalidInput>(vectors);
  NiftiBytes complex;
  complex.datatype = 32;
  complex.bitpix = 64;
  complex.voxels.assign(24 * 8, '\0');
  EXPECT_SAYS(refused<InvalidInput>(complex), "one label a voxel");
}

TEST_F(ReadNifti, EverySpacingMustBePositive) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  for (const float spacing : {0.0F, -2.0F, nan, infinity}) {
    NiftiBytes nifti;
    nifti.pixdim[2] = spacing;
    EXPECT_SAYS(refused<InvalidInput>(nifti), "above 0");
  }
}

TEST_F(ReadNifti, OriginMustBeFinite) {
  NiftiBytes nifti;
  nifti.srow[1][3] = std::numeric_limits<float>::infinity();
  EXPECT_SAYS(refused<InvalidInput>(nifti), "origin");
}

TEST_F(ReadNifti, ScaledValues) {
  NiftiBytes small;
  small.voxels[3] = 5;
  small.scl_slope = 2;
  small.scl_inter = 1;
  EXPECT_EQ(read(small).image.voxels[3], 11U);
  NiftiBytes large;
  large.set_voxels<std::uint32_t>(768, std::vector<std::uint32_t>(24, 4000000001U));
  large.scl_slope = 1;
  EXPECT_EQ(read(large).image.voxels[3], 4000000001U);
  large.scl_inter = 1;
  EXPECT_EQ(read(large).image.voxels[3], 4000000002U);
}

TEST_F(ReadNifti, TruncatedAtAnyPlace) {
  NiftiBytes nifti;
  const std::string whole = nifti.file();
  for (const std::size_t length :
       {std::size_t{1}, std::size_t{100}, std::size_t{347}, std::size_t{352}, whole.size() - 1}) {
    ImageFileTest::refused<IoError>("image.nii", whole.substr(0, length));
  }
}

TEST_F(ReadNifti, HugeDeclaredSizeIsRefusedAtOnce) {
  NiftiBytes nifti;
  nifti.dim = {3, 32767, 32767, 32767, 1, 1, 1, 1};
  EXPECT_SAYS(refused<IoError>(nifti), "cannot hold");
}

TEST_F(ReadNifti, Nifti2IsNamed) {
  std::string bytes(600, '\0');
  const std::int32_t size = 540;
  std::memcpy(bytes.data(), &size, sizeof(size));
  std::memcpy(bytes.data() + 4, "n+2\0\r\n\032\n", 8);
  EXPECT_SAYS(ImageFileTest::refused<InvalidInput>("image.nii", bytes), "NIfTI-2");
}

}  // namespace
}  // namespace anatomesh::testing
