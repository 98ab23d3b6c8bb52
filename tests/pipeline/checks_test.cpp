// What is refused before the work starts.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An option, values that are allowed and values that are not.
struct OptionRange {
  const char* name;
  std::function<void(Options&, double)> set;
  std::vector<double> right, wrong;
};

const std::vector<OptionRange>& option_ranges() {
  static const std::vector<OptionRange> ranges = {
      {"bcc_size_mm", [](Options& o, double v) { o.lattice.bcc_size_mm = v; }, {0, 0.1, 100}, {-1, kNan, kInfinity}},
      {"min_size_mm", [](Options& o, double v) { o.lattice.min_size_mm = v; }, {0, 0.1, 2}, {-1, kNan, kInfinity}},
      {"fidelity", [](Options& o, double v) { o.lattice.fidelity = v; }, {1e-3, 1}, {0, -0.1, 1.01, kNan, kInfinity}},
      {"fidelity_label",
       [](Options& o, double v) { o.lattice.fidelity_label[1] = v; },
       {1e-3, 1},
       {0, -0.1, 1.01, kNan, kInfinity}},
      {"iterations", [](Options& o, double v) { o.deform.iterations = static_cast<int>(v); }, {0, 1, 100}, {-1, 1e6}},
      {"min_dihedral_deg",
       [](Options& o, double v) { o.deform.min_dihedral_deg = v; },
       {0, 30},
       {-1, 30.1, 180, kNan, kInfinity}},
      {"max_dihedral_deg",
       [](Options& o, double v) { o.deform.max_dihedral_deg = v; },
       {117, 180},
       {0, -1, 116, 180.1, kNan, kInfinity}},
      {"min_mean_ratio",
       [](Options& o, double v) { o.deform.min_mean_ratio = v; },
       {0, 0.5},
       {-0.1, 0.51, kNan, kInfinity}},
      {"young_modulus_pa",
       [](Options& o, double v) { o.deform.default_material.young_modulus_pa = v; },
       {1e-3, 1e12},
       {0, -1, kNan, kInfinity}},
      {"poisson_ratio",
       [](Options& o, double v) { o.deform.default_material.poisson_ratio = v; },
       {0, 0.499},
       {-0.1, 0.5, kNan, kInfinity}},
      {"young_modulus_pa",
       [](Options& o, double v) { o.deform.material[1].young_modulus_pa = v; },
       {1e-3, 1e12},
       {0, -1, kNan, kInfinity}},
      {"poisson_ratio",
       [](Options& o, double v) { o.deform.material[1].poisson_ratio = v; },
       {0, 0.499},
       {-0.1, 0.5, kNan, kInfinity}},
      {"threads", [](Options& o, double v) { o.threads = static_cast<int>(v); }, {0, 1, 64}, {-1, 1e6}},
      {"max_memory_gib", [](Options& o, double v) { o.max_memory_gib = v; }, {0, 0.5, 1000}, {-1, kNan, kInfinity}}};
  return ranges;
}

/// Message of the Exception that the call throws; empty, with a failure, when it throws something else or nothing.
template <class Exception>
std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Exception& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another kind of error: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no error";
  return {};
}

bool says(const std::string& message, const std::string& text) { return message.find(text) != std::string::npos; }

TEST(CheckOptions, DefaultsAreRight) { EXPECT_NO_THROW(check_options({})); }

TEST(CheckOptions, RangesAreAsDocumented) {
  for (const OptionRange& option : option_ranges()) {
    for (const double value : option.right) {
      Options options;
      option.set(options, value);
      EXPECT_NO_THROW(check_options(options)) << option.name << " = " << value;
    }
  }
}

TEST(CheckOptions, WrongValuesAreRefusedByName) {
  const LabelImage image = testing::one_voxel();
  for (const OptionRange& option : option_ranges()) {
    for (const double value : option.wrong) {
      SCOPED_TRACE(std::string(option.name) + " = " + std::to_string(value));
      Options options;
      option.set(options, value);
      EXPECT_TRUE(says(message_of<InvalidOption>([&] { check_options(options); }), option.name));
      EXPECT_TRUE(says(message_of<InvalidOption>([&] { image_to_mesh(image, options); }), option.name));
    }
  }
}

TEST(CheckOptions, SmallestSizeIsAtMostTheLargest) {
  Options options;
  options.lattice.bcc_size_mm = 4;
  options.lattice.min_size_mm = 4.1;
  EXPECT_TRUE(says(message_of<InvalidOption>([&] { check_options(options); }), "min_size_mm"));
}

TEST(CheckOptions, SmallestSizeIsAtMostTheLargestByDefault) {
  Options options;
  options.lattice.min_size_mm = 16.1;
  EXPECT_TRUE(says(message_of<InvalidOption>([&] { image_to_mesh(testing::one_voxel(), options); }), "min_size_mm"));
}

TEST(CheckLabels, UnknownOnesAreRefusedByNumber) {
  const LabelImage image = testing::two_touching_cubes();
  const std::vector<std::function<void(Options&)>> changes = {[](Options& o) {
                                                                o.labels = {1, 77};
                                                              },
                                                              [](Options& o) { o.lattice.fidelity_label[77] = 0.9; },
                                                              [](Options& o) { o.deform.material[77] = {}; }};
  for (const auto& change : changes) {
    Options options;
    change(options);
    EXPECT_TRUE(says(message_of<InvalidOption>([&] { image_to_mesh(image, options); }), "77"));
  }
}

TEST(CheckLabels, BackgroundIsNoTissue) {
  const LabelImage image = testing::two_touching_cubes();
  Options options;
  options.lattice.fidelity_label[0] = 0.9;
  EXPECT_THROW(image_to_mesh(image, options), InvalidOption);
  options = {};
  options.labels = {0, 1};
  EXPECT_THROW(image_to_mesh(image, options), InvalidOption);
}

TEST(CheckLabels, OnesThatAreNotMeshedAreRefused) {
  Options options;
  options.labels = {1};
  options.lattice.fidelity_label[2] = 0.9;
  EXPECT_THROW(image_to_mesh(testing::two_touching_cubes(), options), InvalidOption);
}

TEST(CheckLabels, OnlyAbsentLabelsChosen) {
  Options options;
  options.labels = {5, 6};
  EXPECT_THROW(image_to_mesh(testing::two_touching_cubes(), options), InvalidInput);
}

/// A fault of an image, and a word that the message must have.
struct Fault {
  const char* word;
  std::function<void(LabelImage&)> make;
};

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = {{"voxel",
                                          [](LabelImage& i) {
                                            i.size = {0, 0, 0}, i.voxels.clear();
                                          }},
                                         {"axis 1", [](LabelImage& i) { i.size[1] = 0, i.voxels.clear(); }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.x = 0; }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.y = -1; }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.z = kNan; }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.x = kInfinity; }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.y = 1e-7; }},
                                         {"spacing", [](LabelImage& i) { i.spacing_mm.y = 1e7; }},
                                         {"origin", [](LabelImage& i) { i.origin_mm.y = 1e9; }},
                                         {"origin", [](LabelImage& i) { i.origin_mm.y = kNan; }},
                                         {"origin", [](LabelImage& i) { i.origin_mm.z = kInfinity; }},
                                         {"labels", [](LabelImage& i) { i.voxels.pop_back(); }},
                                         {"labels", [](LabelImage& i) { i.voxels.push_back(1); }},
                                         {"rotation", [](LabelImage& i) { i.direction[0][0] = 2; }},
                                         {"rotation", [](LabelImage& i) { i.direction[0][1] = 0.1; }},
                                         {"rotation", [](LabelImage& i) { i.direction = {}; }},
                                         {"rotation", [](LabelImage& i) { i.direction[2][2] = kNan; }}};
  return all;
}

TEST(CheckImage, FaultsAreNamed) {
  for (const Fault& fault : faults()) {
    LabelImage image = testing::sphere(3);
    fault.make(image);
    SCOPED_TRACE(fault.word);
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { check_image(image); }), fault.word));
    EXPECT_TRUE(says(message_of<InvalidInput>([&] { image_to_mesh(image); }), fault.word));
  }
}

TEST(CheckImage, GeneratedOnesAreRight) {
  for (const auto& [name, image] : testing::all_test_images()) EXPECT_NO_THROW(check_image(image)) << name;
}

TEST(CheckImage, AllBackgroundIsRefused) {
  const LabelImage image = testing::make_image({4, 4, 4}, [](int, int, int) { return Label{0}; });
  EXPECT_TRUE(says(message_of<InvalidInput>([&] { image_to_mesh(image); }), "background"));
}

TEST(CheckMemory, MoreThanAllowedIsRefusedBeforehand) {
  Options options;
  options.max_memory_gib = 1e-6;
  EXPECT_TRUE(says(message_of<InvalidInput>([&] { image_to_mesh(testing::sphere(), options); }), "memory"));
  options.max_memory_gib = 1;
  EXPECT_NO_THROW(image_to_mesh(testing::sphere(), options));
}

TEST(CheckMemory, LatticeThatOutgrowsItIsRefused) {
  const LabelImage image = testing::sphere(24);
  Options options;
  options.lattice.bcc_size_mm = 4 * image.spacing_mm.x;
  options.lattice.fidelity_stage = FidelityStage::lattice;
  options.lattice.min_size_mm = image.spacing_mm.x / 8;
  options.lattice.fidelity = 1;
  options.max_memory_gib = 0.02;
  EXPECT_TRUE(says(message_of<InvalidInput>([&] { image_to_mesh(image, options); }), "memory"));
  options.lattice.fidelity = 0.5;
  EXPECT_NO_THROW(image_to_mesh(image, options));
}

// Sizes that nobody means must end in an error or a mesh, not in a crash or in swapping.
void expect_error_or_mesh(const Options& options) {
  try {
    EXPECT_FALSE(image_to_mesh(testing::sphere(4), options).mesh.tets.empty());
  } catch (const Error& error) {
    EXPECT_STRNE(error.what(), "");
  }
}

TEST(CheckMemory, AbsurdSizesEndInAnErrorOrAMesh) {
  for (const double size : {1e-300, 1e-9, 1e-3, 1e6, 1e30, 1e300}) {
    SCOPED_TRACE(size);
    Options options;
    options.max_memory_gib = 1;
    options.lattice.bcc_size_mm = size;
    expect_error_or_mesh(options);
  }
}

TEST(CheckMemory, AbsurdSmallestSizesEndInAnErrorOrAMesh) {
  for (const double size : {1e-300, 1e-9, 1e-4}) {
    for (const double fidelity : {0.95, 1.0}) {
      SCOPED_TRACE(size);
      Options options;
      options.max_memory_gib = 0.1;
      options.lattice.min_size_mm = size;
      options.lattice.fidelity = fidelity;
      expect_error_or_mesh(options);
    }
  }
}

}  // namespace
}  // namespace anatomesh
