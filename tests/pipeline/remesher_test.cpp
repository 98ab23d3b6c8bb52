// Meshes that follow changes of their image: every guarantee after every update.
#include "anatomesh/remesher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <string>

#include "anatomesh/assess.h"
#include "anatomesh/errors.h"
#include "pipeline/guarantees.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// Four sectors of a ball around one corner, in a cube of 48 voxels; label 5 is a rod through three of them.
LabelImage anatomy() {
  constexpr int kSide = 48;
  return testing::make_image({kSide, kSide, kSide}, [](int i, int j, int k) {
    const double x = i - 23.3, y = j - 23.6, z = k - 23.8;
    if (x * x + y * y + z * z > 20.5 * 20.5) return Label{0};
    if (y * y + (z - 6) * (z - 6) < 9) return Label{5};
    return static_cast<Label>(1 + (x > 0) + 2 * (y > 0.3 * x));
  });
}

struct Ball {
  double i, j, k, radius;
  bool operator()(std::size_t a, std::size_t b, std::size_t c) const {
    const double x = static_cast<double>(a) - i, y = static_cast<double>(b) - j, z = static_cast<double>(c) - k;
    return x * x + y * y + z * z <= radius * radius;
  }
};

/// Gives the voxels (i, j, k) with holds(i, j, k) a label, where may_take(label before).
template <class Holds, class MayTake>
LabelImage painted(LabelImage image, const Holds& holds, Label label, const MayTake& may_take) {
  std::size_t v = 0;
  for (std::size_t k = 0; k < image.size[2]; ++k) {
    for (std::size_t j = 0; j < image.size[1]; ++j) {
      for (std::size_t i = 0; i < image.size[0]; ++i, ++v) {
        if (holds(i, j, k) && may_take(image.voxels[v])) image.voxels[v] = label;
      }
    }
  }
  return image;
}

bool everywhere(std::size_t, std::size_t, std::size_t) { return true; }
bool slab(std::size_t i, std::size_t, std::size_t) { return i >= 22 && i < 26; }
bool any(Label) { return true; }
bool tissue(Label label) { return label != 0; }
bool background(Label label) { return label == 0; }
template <Label own>
bool only(Label label) {
  return label == own;
}

void expect_sound(const LabelImage& image, const Remesher& mesher) {
  const Result& result = mesher.result();
  testing::expect_valid(image, result);
  testing::expect_bounded(result);
  testing::expect_complete(image, result);
  testing::expect_in_place(image, result);
  testing::expect_fidelity_as_measured(image, result);
  testing::expect_manifold(result);
  testing::expect_components(image, result);
  AssessOptions options;
  options.frame = result.options.frame;
  options.distances = false;
  options.min_dihedral_deg = result.options.deform.min_dihedral_deg;
  options.max_dihedral_deg = result.options.deform.max_dihedral_deg;
  options.min_mean_ratio = result.options.deform.min_mean_ratio;
  EXPECT_EQ(failed_guarantees(assess(result.mesh, &image, options), options), std::vector<std::string>());
}

/// Volumes of tissues of many voxels within 1 %.
void expect_volumes(const LabelImage& image, const Remesher& mesher) {
  AssessOptions options;
  options.distances = false;
  for (const TissueAssessment& t : assess(mesher.result().mesh, &image, options).tissues) {
    if (t.fidelity.image_voxels < 1000) continue;
    EXPECT_LE(std::abs(t.fidelity.volume_error_percent), 1) << "label " << t.label;
  }
}

void expect_good(const LabelImage& image, const Remesher& mesher) {
  expect_sound(image, mesher);
  testing::expect_faithful(mesher.result());
  expect_volumes(image, mesher);
}

bool same_bytes(const TetMesh& a, const TetMesh& b) {
  return a.points_mm == b.points_mm && a.tets == b.tets && a.labels == b.labels;
}

TEST(Remesher, BeginsWithTheMeshOfTheImage) {
  const LabelImage image = testing::three_label_junction();
  const Remesher mesher(image);
  EXPECT_TRUE(same_bytes(mesher.result().mesh, image_to_mesh(image).mesh));
}

TEST(Remesher, ImageThatIsTheSameChangesNothing) {
  const LabelImage image = testing::three_label_junction();
  Remesher mesher(image);
  const TetMesh before = mesher.result().mesh;
  const UpdateReport report = mesher.update(image);
  EXPECT_EQ(report.changed_voxels, 0u);
  EXPECT_EQ(report.new_tets, 0u);
  EXPECT_FALSE(report.whole);
  EXPECT_TRUE(same_bytes(mesher.result().mesh, before));
}

struct Change {
  const char* name;
  std::function<bool(std::size_t, std::size_t, std::size_t)> holds;
  Label label;
  bool (*may_take)(Label);
  bool may_mesh_anew = false;
};

class RemesherChange : public ::testing::TestWithParam<Change> {};

TEST_P(RemesherChange, IsFollowed) {
  const LabelImage before = anatomy();
  const LabelImage image = painted(before, GetParam().holds, GetParam().label, GetParam().may_take);
  Remesher mesher(before);
  const UpdateReport report = mesher.update(image);
  std::uint64_t changed = 0;
  for (std::size_t v = 0; v < image.voxels.size(); ++v) changed += image.voxels[v] != before.voxels[v];
  EXPECT_GT(changed, 100u);
  EXPECT_EQ(report.changed_voxels, changed);
  EXPECT_TRUE(GetParam().may_mesh_anew || !report.whole) << report.reason;
  expect_good(image, mesher);
}

INSTANTIATE_TEST_SUITE_P(All, RemesherChange,
                         ::testing::Values(Change{"ResectionToBackground", Ball{40, 24, 24, 8}, 0, tissue},
                                           Change{"ClosedCavity", Ball{24, 13, 24, 5}, 0, tissue},
                                           Change{"ResectionToANewLabel", Ball{20, 22, 16, 7}, 70000, tissue},
                                           Change{"BrushGrowsATissueIntoAnother", Ball{24, 15, 20, 6}, 1, tissue},
                                           Change{"BrushGrowsATissueIntoTheBackground", Ball{24, 41, 24, 6}, 3,
                                                  background},
                                           Change{"TissueThatIsRemoved", everywhere, 0, only<5>, true},
                                           Change{"TissueThatTakesAnother", everywhere, 1, only<2>, true},
                                           Change{"TissueIsCutInTwo", slab, 1, only<5>, true}),
                         [](const auto& change) { return std::string(change.param.name); });

TEST(Remesher, TissueThatComesFarFromAllOthers) {
  LabelImage image = testing::make_image({64, 24, 24}, [](int i, int j, int k) {
    return static_cast<Label>((i - 12) * (i - 12) + (j - 12) * (j - 12) + (k - 12) * (k - 12) < 64);
  });
  Remesher mesher(image);
  image = painted(image, Ball{50, 12, 12, 7}, 9, any);
  mesher.update(image);
  expect_good(image, mesher);
}

TEST(Remesher, ObliqueLeftHandedAndAnisotropicImages) {
  for (const LabelImage& plain :
       {testing::oblique(anatomy()), testing::left_handed(anatomy()), testing::anisotropic(anatomy())}) {
    LabelImage image = plain;
    Options options;
    options.frame = Frame::ras;
    Remesher mesher(image, options);
    image = painted(image, Ball{24, 36, 24, 7}, 0, tissue);
    mesher.update(image);
    expect_sound(image, mesher);
  }
}

TEST(Remesher, OtherBounds) {
  for (const auto& [low, high, ratio] : {std::array{10., 160., 0.2}, std::array{24., 140., 0.35}}) {
    LabelImage image = anatomy();
    Options options;
    options.deform.min_dihedral_deg = low;
    options.deform.max_dihedral_deg = high;
    options.deform.min_mean_ratio = ratio;
    Remesher mesher(image, options);
    image = painted(image, Ball{40, 24, 24, 8}, 0, tissue);
    const UpdateReport report = mesher.update(image);
    EXPECT_FALSE(report.whole) << report.reason;
    expect_sound(image, mesher);
  }
}

TEST(Remesher, TenStrokesDoNotDegradeTheMesh) {
  LabelImage image = anatomy();
  Remesher mesher(image);
  int local = 0;
  for (int n = 0; n < 10; ++n) {
    SCOPED_TRACE("stroke " + std::to_string(n));
    const double angle = 0.6 * n;
    const Ball ball = {23 + 14 * std::cos(angle), 23 + 14 * std::sin(angle), 16.0 + 1.5 * n, 4};
    image = painted(image, ball, static_cast<Label>(n % 3 == 0 ? 0 : 1 + n % 4), tissue);
    const UpdateReport report = mesher.update(image);
    local += !report.whole;

    expect_good(image, mesher);
  }
  EXPECT_GE(local, 6);
  // Not many more tetrahedra than a fresh mesh takes.
  EXPECT_LT(mesher.result().mesh.tets.size(), 2 * image_to_mesh(image).mesh.tets.size());
}

TEST(Remesher, SameBytesForAnyNumberOfThreads) {
  const LabelImage first = anatomy();
  const LabelImage second = painted(first, Ball{40, 24, 24, 8}, 0, tissue);
  const LabelImage third = painted(second, Ball{20, 22, 16, 6}, 9, tissue);
  TetMesh expected;
  for (const int threads : {1, 2, 8}) {
    Options options;
    options.threads = threads;
    Remesher mesher(first, options);
    mesher.update(second);
    mesher.update(third);
    if (threads == 1) expected = mesher.result().mesh;
    EXPECT_TRUE(same_bytes(mesher.result().mesh, expected)) << threads << " threads";
  }
}

TEST(Remesher, AnotherGridIsAnError) {
  LabelImage image = testing::sphere();
  Remesher mesher(image);
  const TetMesh before = mesher.result().mesh;
  const auto expect_error = [&](const LabelImage& other, const std::string& what) {
    try {
      mesher.update(other);
      FAIL() << "no error for another " << what;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  LabelImage other = image;
  other.spacing_mm.y = 1.5;
  expect_error(other, "spacing");
  other = image;
  other.origin_mm.x += 1;
  expect_error(other, "origin");
  other = image;
  other.direction[0][0] = -1;
  expect_error(other, "direction");
  expect_error(testing::sphere(6), "size");
  other = image;
  std::ranges::fill(other.voxels, Label{0});
  EXPECT_THROW(mesher.update(other), InvalidInput);
  EXPECT_TRUE(same_bytes(mesher.result().mesh, before));
}

TEST(Remesher, CancelledUpdateLeavesTheMesh) {
  LabelImage image = anatomy();
  Remesher mesher(image);
  const TetMesh before = mesher.result().mesh;
  std::stop_source stop;
  stop.request_stop();
  Progress progress;
  progress.cancel = stop.get_token();
  const LabelImage changed = painted(image, Ball{40, 24, 24, 8}, 0, tissue);
  EXPECT_THROW(mesher.update(changed, progress), Cancelled);
  EXPECT_TRUE(same_bytes(mesher.result().mesh, before));
  EXPECT_FALSE(mesher.update(changed).whole);
  expect_good(changed, mesher);
}

TEST(Remesher, ProgressRises) {
  LabelImage image = anatomy();
  Remesher mesher(image);
  for (const bool whole : {false, true}) {
    image = painted(image, Ball{40, 24, whole ? 30. : 18., 7}, whole ? 8 : 0, tissue);
    Progress progress;
    double last = 0;
    progress.report = [&](std::string_view, double fraction) {
      EXPECT_GE(fraction, last);
      last = fraction;
    };
    mesher.update(image, progress);
    EXPECT_EQ(last, 1);
  }
}

TEST(Remesher, OptionsThatAreNotFollowedLocallyMeshAnew) {
  LabelImage image = anatomy();
  Options options;
  options.lattice.max_elements = 8000;
  Remesher mesher(image, options);
  image = painted(image, Ball{40, 24, 24, 8}, 0, tissue);
  const UpdateReport report = mesher.update(image);
  EXPECT_TRUE(report.whole);
  EXPECT_NE(report.reason.find("max_elements"), std::string::npos);
  EXPECT_LE(mesher.result().mesh.tets.size(), 8000u);
  EXPECT_TRUE(same_bytes(mesher.result().mesh, image_to_mesh(image, options).mesh));
}

TEST(Remesher, LabelsNamedInOptionsMayVanish) {
  LabelImage image = anatomy();
  Options options;
  options.lattice.fidelity_label[5] = 0.9;
  options.labels = {1, 2, 3, 5};
  Remesher mesher(image, options);
  std::ranges::replace(image.voxels, Label{5}, Label{1});
  mesher.update(image);
  EXPECT_EQ(mesher.result().tissues.size(), 3u);
  std::ranges::replace(image.voxels, Label{4}, Label{0});
  expect_sound(image, mesher);
}

#ifdef __SANITIZE_ADDRESS__
constexpr unsigned kSeeds = 4;  // each takes twenty times as long
#else
constexpr unsigned kSeeds = 12;
#endif

TEST(Remesher, GuaranteesHoldAfterRandomChangesOfSmallImages) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto between = [&](int low, int high) {
      return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
    };
    const int side = between(8, 20);
    LabelImage image =
        seed % 3 ? testing::random_blobs(seed, side, between(3, 10)) : testing::noise(seed, between(4, 6), 3);
    for (std::size_t a = 0; a < 3; ++a) image.spacing_mm[a] = 0.4 + 0.2 * between(0, 8);
    Remesher mesher(image);
    const int size = static_cast<int>(image.size[0]);
    for (int stroke = 0; stroke < 4; ++stroke) {
      SCOPED_TRACE("stroke " + std::to_string(stroke));
      const Ball ball = {1. * between(0, size), 1. * between(0, size), 1. * between(0, size), 0.5 * between(1, 10)};
      image = painted(image, ball, static_cast<Label>(between(0, 5)), any);
      if (std::ranges::all_of(image.voxels, [](Label label) { return label == 0; })) break;
      mesher.update(image);
      testing::expect_valid(image, mesher.result());
      testing::expect_bounded(mesher.result());
      testing::expect_complete(image, mesher.result());
      testing::expect_manifold(mesher.result());
      testing::expect_components(image, mesher.result());
    }
  }
}

}  // namespace
}  // namespace anatomesh
