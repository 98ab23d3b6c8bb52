// FreeSurfer's volumes, made byte by byte; tests/tools/mgz_test.py compares with nibabel's.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "io/image_file_fixture.h"

namespace anatomesh::testing {
namespace {

/// An .mgh file of 4 x 3 x 2 voxels of 8 bits, all 0, 1 x 2 x 3 mm, its axes those of RAS, around (10, 20, 30).
struct Mgh {
  std::int32_t version = 1;
  std::array<std::int32_t, 4> size = {4, 3, 2, 1};
  std::int32_t type = 0;
  std::int16_t has_place = 1;
  std::array<float, 3> spacing = {1, 2, 3};
  std::array<float, 9> axes = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<float, 3> centre = {10, 20, 30};
  std::string voxels = std::string(24, '\0');

  std::string file() const {
    std::string bytes(284, '\0');
    std::size_t at = 0;
    const auto put = [&](auto number) {
      char raw[sizeof(number)];
      std::memcpy(raw, &number, sizeof(number));
      std::reverse_copy(raw, raw + sizeof(number), bytes.begin() + static_cast<std::ptrdiff_t>(at));
      at += sizeof(number);
    };
    put(version);
    for (const std::int32_t n : size) put(n);
    put(type);
    put(std::int32_t{0});
    put(has_place);
    for (const float x : spacing) put(x);
    for (const float x : axes) put(x);
    for (const float x : centre) put(x);
    return bytes + voxels;
  }

  template <typename Value>
  void set_voxels(std::int32_t code, const std::vector<Value>& values) {
    type = code;
    voxels.clear();
    for (const Value value : values) {
      char raw[sizeof(value)];
      std::memcpy(raw, &value, sizeof(value));
      std::reverse(raw, raw + sizeof(value));
      voxels.append(raw, sizeof(value));
    }
  }
};

class ReadMgh : public MadeImageTest<Mgh> {
 protected:
  ReadMgh() : MadeImageTest("a.mgh") {}
};

TEST_F(ReadMgh, PlaceIsThatOfTheCentre) {
  const LabelImage image = read({}).image;
  EXPECT_EQ(image.size, (std::array<std::size_t, 3>{4, 3, 2}));
  EXPECT_EQ(image.spacing_mm, (Vec3{1, 2, 3}));
  EXPECT_EQ(image.origin_mm, (Vec3{-8, -17, 27}));  // RAS: 10 - 4/2, 20 - 2 3/2, 30 - 3 2/2
  EXPECT_EQ(image.direction, (Mat3{{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}));
}

TEST_F(ReadMgh, ObliqueAndLeftHanded) {
  const LabelImage image = read({.axes = {0.6F, 0.8F, 0, 0.8F, -0.6F, 0, 0, 0, 1}, .centre = {0, 0, 0}}).image;
  const Mat3 expected = {{{-0.6, -0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
  expect_near(image.direction, expected, 1e-7);
  expect_near(image.origin_mm, {0.6 * 2 + 0.8 * 3, 0.8 * 2 - 0.6 * 3, -3}, 1e-6);
}

TEST_F(ReadMgh, WithoutPlaceItIsCoronalAsInFreeSurfer) {
  const ImageFile file = read({.has_place = 0, .spacing = {9, 9, 9}, .centre = {7, 7, 7}});
  EXPECT_EQ(file.image.spacing_mm, (Vec3{1, 1, 1}));
  EXPECT_EQ(file.image.direction, (Mat3{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}}));
  EXPECT_EQ(file.image.origin_mm, (Vec3{-2, 1, 1.5}));
  EXPECT_SAYS(only_note(file), "does not say where it lies");
}

TEST_F(ReadMgh, VoxelsOfAllTypes) {
  std::vector<int> values(24);
  for (int n = 0; n < 24; ++n) values[static_cast<std::size_t>(n)] = 5 * n;
  const auto check = [&](std::int32_t code, auto kind) {
    Mgh mgh;
    mgh.set_voxels(code, std::vector<decltype(kind)>(values.begin(), values.end()));
    EXPECT_TRUE(std::ranges::equal(read(mgh).image.voxels, values)) << code;
  };
  check(0, std::uint8_t{});
  check(1, std::int32_t{});
  check(3, float{});
  check(4, std::int16_t{});
  check(10, std::uint16_t{});
}

TEST_F(ReadMgh, CompressedAndWithWhatFollowsTheVoxels) {
  Mgh mgh;
  mgh.voxels[5] = 42;
  const std::string bytes = mgh.file() + "TR, flip angle, tags and the like";
  for (const char* name : {"a.mgz", "a.mgh.gz"}) {
    const auto path = in_folder(name);
    gzFile zip = gzopen(path.c_str(), "wb");
    gzwrite(zip, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(zip);
    EXPECT_EQ(read_label_image(path).image.voxels[5], 42U);
    const std::string packed = bytes_of(path);
    for (const std::size_t left : {std::size_t{5}, packed.size() / 2, packed.size() - 4}) {
      EXPECT_THROW(read_label_image(put(name, packed.substr(0, left))), IoError) << left;
    }
  }
}

TEST_F(ReadMgh, WhatIsWrongIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>({.size = {4, 3, 2, 5}}), "5 frames");
  EXPECT_SAYS(refused<InvalidInput>({.size = {4, 0, 2, 1}}), "4 x 0 x 2");
  EXPECT_SAYS(refused<InvalidInput>({.size = {4, -3, 2, 1}}), "4 x -3 x 2");
  EXPECT_SAYS(refused<InvalidInput>({.type = 7}), "MGH type 7");
  EXPECT_SAYS(refused<InvalidInput>({.spacing = {1, 0, 1}}), "1, 0, 1");
  EXPECT_SAYS(refused<InvalidInput>({.spacing = {1, NAN, 1}}), "spacing");
  EXPECT_SAYS(refused<InvalidInput>({.centre = {INFINITY, 0, 0}}), "origin");
  EXPECT_SAYS(refused<InvalidInput>({.axes = {1, 0, 0, 0.5F, 1, 0, 0, 0, 1}}), "direction");
  EXPECT_SAYS(refused<InvalidInput>({.axes = {}}), "direction");
  EXPECT_SAYS(refused<IoError>({.version = 348}), "version is 348");
  EXPECT_SAYS(refused<IoError>({.voxels = std::string(23, '\0')}), "23 of the 24 bytes");
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  EXPECT_SAYS(refused<IoError>({.size = {kMost, kMost, kMost, 1}, .type = 1}), "cannot hold");
  Mgh fractional;
  fractional.set_voxels(3, std::vector<float>(24, 1.5F));
  EXPECT_SAYS(refused<InvalidInput>(fractional), "1.5");
  Mgh negative;
  negative.set_voxels(4, std::vector<std::int16_t>(24, -2));
  EXPECT_SAYS(refused<InvalidInput>(negative), "-2");
}

TEST_F(ReadMgh, TruncatedHeaders) {
  const std::string good = Mgh().file();
  for (const std::size_t left : {1U, 30U, 283U}) {
    EXPECT_THROW(read_label_image(put("a.mgh", good.substr(0, left))), IoError) << left;
  }
}

}  // namespace
}  // namespace anatomesh::testing
