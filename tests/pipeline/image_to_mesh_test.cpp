#include "anatomesh/image_to_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <thread>

#include "anatomesh/errors.h"
#include "base/vec.h"
#include "pipeline/guarantees.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

bool same_bytes(const TetMesh& a, const TetMesh& b) {
  return a.tets == b.tets && a.labels == b.labels && a.points_mm.size() == b.points_mm.size() &&
         std::memcmp(a.points_mm.data(), b.points_mm.data(), a.points_mm.size() * sizeof(Vec3)) == 0;
}

TetMesh mesh_of(const LabelImage& image, const Options& options = {}) { return image_to_mesh(image, options).mesh; }

TEST(Reproducible, SameBytesForAnyNumberOfThreads) {
  for (const LabelImage& image :
       {testing::random_blobs(1, 32, 20), testing::vessel_tree(), testing::noise(3, 12, 20)}) {
    Options options;
    options.threads = 1;
    const TetMesh first = mesh_of(image, options);
    for (const int threads : {1, 2, 4, 0}) {
      options.threads = threads;
      EXPECT_TRUE(same_bytes(first, mesh_of(image, options))) << threads << " threads";
    }
  }
}

TEST(Reproducible, SameBytesFromSeveralCallsAtOnce) {
  const LabelImage image = testing::four_label_point();
  const TetMesh alone = mesh_of(image);
  std::array<TetMesh, 3> together;
  std::vector<std::thread> callers;
  for (TetMesh& mesh : together) callers.emplace_back([&] { mesh = mesh_of(image); });
  for (std::thread& caller : callers) caller.join();
  for (const TetMesh& mesh : together) EXPECT_TRUE(same_bytes(alone, mesh));
}

TEST(Frame, RasIsLpsWithTwoAxesReversed) {
  for (const LabelImage& image : {testing::oblique(testing::three_label_junction()),
                                  testing::left_handed(testing::anisotropic(testing::vessel_tree()))}) {
    Options options;
    const TetMesh lps = mesh_of(image, options);
    options.frame = Frame::ras;
    const TetMesh ras = mesh_of(image, options);
    EXPECT_EQ(lps.tets, ras.tets);
    EXPECT_EQ(lps.labels, ras.labels);
    ASSERT_EQ(lps.points_mm.size(), ras.points_mm.size());
    for (std::size_t v = 0; v < lps.points_mm.size(); ++v) {
      const Vec3 p = lps.points_mm[v];
      EXPECT_EQ(ras.points_mm[v], (Vec3{-p.x, -p.y, p.z}));
    }
  }
}

std::vector<Vec3> centres_of(const TetMesh& mesh) {
  std::vector<Vec3> centres;
  for (const auto& tet : mesh.tets) {
    centres.emplace_back();
    for (const VertexId v : tet) centres.back() += 0.25 * mesh.points_mm[v];
  }
  return centres;
}

// Vertices may have other numbers in a mirrored image.
TEST(Frame, DirectionAndOriginMoveTheMeshOnly) {
  const LabelImage plain = testing::anisotropic(testing::vessel_tree());
  const TetMesh in_image = mesh_of(plain);
  const auto before = centres_of(in_image);
  for (const LabelImage& image : {testing::oblique(plain), testing::left_handed(plain)}) {
    const TetMesh moved = mesh_of(image);
    const auto after = centres_of(moved);
    EXPECT_EQ(moved.labels, in_image.labels);
    ASSERT_EQ(after.size(), before.size());
    double worst = 0;
    for (std::size_t t = 0; t < after.size(); ++t)
      worst = std::max(worst, norm(after[t] - (image.origin_mm + image.direction * before[t])));
    EXPECT_LT(worst, 1e-9);
  }
}

TEST(Labels, ASubsetIsMeshedAsIfTheRestWereBackground) {
  const LabelImage image = testing::nested_spheres();
  Options options;
  options.labels = {70000, 4294967295u};
  LabelImage without = image;
  std::replace(without.voxels.begin(), without.voxels.end(), Label{3}, Label{0});
  const Result chosen = image_to_mesh(image, options);
  EXPECT_TRUE(same_bytes(chosen.mesh, mesh_of(without)));
  testing::expect_guarantees(image, chosen);
}

TEST(Labels, AreMeshedInTheImagesOrderAndValues) {
  const Result result = image_to_mesh(testing::nested_spheres());
  ASSERT_EQ(result.tissues.size(), 3u);
  EXPECT_EQ(result.tissues[0].label, 3u);
  EXPECT_EQ(result.tissues[1].label, 70000u);
  EXPECT_EQ(result.tissues[2].label, 4294967295u);
}

TEST(Labels, FidelityOfOneIsReported) {
  Options options;
  options.lattice.fidelity_label[2] = 0.8;
  const Result result = image_to_mesh(testing::two_touching_cubes(), options);
  EXPECT_EQ(result.tissues[0].fidelity, 0.95);
  EXPECT_EQ(result.tissues[1].fidelity, 0.8);
}

std::map<Label, double> volumes(const TetMesh& mesh) {
  std::map<Label, double> volume;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh.tets[t];
    const auto& p = mesh.points_mm;
    volume[mesh.labels[t]] += dot(cross(p[b] - p[a], p[c] - p[a]), p[d] - p[a]) / 6;
  }
  return volume;
}

// Small convex tissues lose some volume to the smooth surface.
TEST(Volumes, AreNearThoseOfTheVoxels) {
  for (const LabelImage& image : {testing::nested_spheres(), testing::anisotropic(testing::two_touching_cubes()),
                                  testing::three_label_junction(), testing::four_label_point()}) {
    std::map<Label, double> voxels;
    for (const Label label : image.voxels) ++voxels[label];
    const double voxel = image.spacing_mm.x * image.spacing_mm.y * image.spacing_mm.z;
    for (const auto& [label, volume] : volumes(mesh_of(image)))
      EXPECT_NEAR(volume / (voxels[label] * voxel), 1, voxels[label] > 500 ? 0.1 : 0.2) << label;
  }
}

TEST(Volumes, HardlyChangeWithTheOrderOfTheAxes) {
  const LabelImage image = testing::random_blobs(7);
  const LabelImage turned = testing::make_image({24, 24, 24}, [&](int i, int j, int k) {
    return image.at(static_cast<std::size_t>(k), static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  });
  auto before = volumes(mesh_of(image));
  for (const auto& [label, volume] : volumes(mesh_of(turned))) EXPECT_NEAR(volume / before[label], 1, 0.02) << label;
}

TEST(Progress, NeverFallsAndEndsAtOne) {
  const auto caller = std::this_thread::get_id();
  double last = 0;
  std::vector<std::string> stages;
  const Progress progress{[&](std::string_view stage, double fraction) {
                            EXPECT_EQ(std::this_thread::get_id(), caller);
                            EXPECT_GE(fraction, last);
                            EXPECT_LE(fraction, 1);
                            last = fraction;
                            stages.emplace_back(stage);
                          },
                          {}};
  image_to_mesh(testing::vessel_tree(), {}, progress);
  EXPECT_EQ(last, 1);
  EXPECT_GE(stages.size(), 10u);
}

TEST(Cancel, BeforeTheCall) {
  std::stop_source source;
  source.request_stop();
  EXPECT_THROW(image_to_mesh(testing::sphere(), {}, {{}, source.get_token()}), Cancelled);
}

TEST(Cancel, AtEveryReport) {
  const LabelImage image = testing::four_label_point();
  int reports = 0;
  image_to_mesh(image, {}, {[&](std::string_view, double) { ++reports; }, {}});
  for (int stop_at = 1; stop_at < reports; ++stop_at) {
    std::stop_source source;
    int report = 0;
    const auto count = [&](std::string_view, double) {
      if (++report == stop_at) source.request_stop();
    };
    EXPECT_THROW(image_to_mesh(image, {}, {count, source.get_token()}), Cancelled) << "report " << stop_at;
    EXPECT_EQ(report, stop_at);
  }
}

TEST(Options, SizesAreFilledInFromTheSpacing) {
  const double voxel_mm = (0.7 + 1.1 + 2.5) / 3;
  const LabelImage image = testing::anisotropic(testing::sphere());
  const LatticeOptions final = image_to_mesh(image).options.lattice;
  EXPECT_GT(final.bcc_size_mm, 8 * voxel_mm);
  EXPECT_LE(final.bcc_size_mm, 16 * voxel_mm);
  EXPECT_DOUBLE_EQ(final.min_size_mm, voxel_mm / 2);

  Options options;
  options.lattice.fidelity_stage = FidelityStage::lattice;
  const LatticeOptions lattice = image_to_mesh(image, options).options.lattice;
  EXPECT_DOUBLE_EQ(lattice.bcc_size_mm, 8 * voxel_mm);
  EXPECT_DOUBLE_EQ(lattice.min_size_mm, 2 * voxel_mm);
}

TEST(Options, AGivenRootIsKept) {
  Options options;
  options.lattice.bcc_size_mm = 5.3;
  const LatticeOptions used = image_to_mesh(testing::sphere(), options).options.lattice;
  EXPECT_EQ(used.bcc_size_mm, 5.3);
  EXPECT_DOUBLE_EQ(used.min_size_mm, 5.3 / 8);
}

TEST(Options, WithoutIterationsTheLatticeIsKept) {
  Options options;
  options.lattice.bcc_size_mm = 8;
  options.deform.iterations = 0;
  const TetMesh mesh = mesh_of(testing::sphere(), options);
  const Vec3 first = mesh.points_mm[0];
  for (const Vec3 p : mesh.points_mm) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double quarters = (p[a] - first[a]) / (8.0 / 32);
      EXPECT_NEAR(quarters, std::round(quarters), 1e-9);
    }
  }
}

TEST(Options, EveryNonConnectivityPatternGivesAGoodMesh) {
  const LabelImage image = testing::three_label_junction();
  for (const auto pattern :
       {NonConnectivity::vertex, NonConnectivity::edge, NonConnectivity::face, NonConnectivity::none}) {
    Options options;
    options.deform.non_connectivity = pattern;
    testing::expect_guarantees(image, image_to_mesh(image, options));
  }
}

TEST(Result, StagesAreTimed) {
  const Result result = image_to_mesh(testing::sphere());
  EXPECT_GE(result.times.size(), 3u);
  for (const StageTime& time : result.times) {
    EXPECT_FALSE(time.stage.empty());
    EXPECT_GE(time.seconds, 0);
  }
}

}  // namespace
}  // namespace anatomesh
