// Small random images: every guarantee on each of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pipeline/guarantees.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// 3 to 12 voxels a side; labels from blocks of random size and, in some images, noise; any spacing.
LabelImage random_image(std::mt19937& random) {
  const auto between = [&](unsigned low, unsigned high) {
    return low + static_cast<unsigned>(random() % (high - low + 1));
  };
  const std::array<std::size_t, 3> size = {between(3, 12), between(3, 12), between(3, 12)};
  const int block = static_cast<int>(between(1, 5));
  const unsigned labels = between(1, 6), noise_percent = between(0, 2) * between(0, 20);
  std::vector<Label> of_block;
  for (int n = 0; n < 12 * 12 * 12; ++n) of_block.push_back(static_cast<Label>(random() % (labels + 1)));
  LabelImage image = testing::make_image(size, [&](int i, int j, int k) {
    if (random() % 100 < noise_percent) return static_cast<Label>(random() % (labels + 1));
    return of_block[static_cast<std::size_t>(i / block + 12 * (j / block + 12 * (k / block)))];
  });
  image.voxels[random() % image.voxels.size()] = 1;  // not all background
  for (std::size_t a = 0; a < 3; ++a) image.spacing_mm[a] = 0.2 + 0.1 * between(0, 30);
  return image;
}

Options random_options(std::mt19937& random) {
  constexpr std::array<double, 5> kSizes = {0, 0, 3, 6.5, 11};
  constexpr std::array<double, 4> kFidelities = {0.5, 0.9, 0.95, 1};
  constexpr std::array<int, 4> kIterations = {0, 1, 3, 10};
  constexpr std::array<std::array<double, 2>, 4> kAngles = {{{15, 155}, {20, 150}, {5, 170}, {28, 120}}};
  Options options;
  options.lattice.bcc_size_mm = kSizes[random() % kSizes.size()];
  options.lattice.fidelity = kFidelities[random() % kFidelities.size()];
  options.deform.iterations = kIterations[random() % kIterations.size()];
  options.deform.min_dihedral_deg = kAngles[random() % kAngles.size()][0];
  options.deform.max_dihedral_deg = kAngles[random() % kAngles.size()][1];
  options.deform.non_connectivity = static_cast<NonConnectivity>(random() % 4);
  options.frame = random() % 2 ? Frame::lps : Frame::ras;
  return options;
}

/// Whether the mesh is fine enough, and asked to be faithful enough, to lie near its voxels.
bool is_fine(const LabelImage& image, const Options& options) {
  const Vec3 s = image.spacing_mm;
  return options.lattice.min_size_mm < std::min({s.x, s.y, s.z}) && options.lattice.fidelity >= 0.9;
}

#ifdef __SANITIZE_ADDRESS__
constexpr unsigned kSeeds = 8;  // each takes twenty times as long
#else
constexpr unsigned kSeeds = 40;
#endif

TEST(Fuzz, GuaranteesHoldOnSmallRandomImages) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    LabelImage image = random_image(random);
    if (seed % 3 == 1) image = testing::oblique(image);
    if (seed % 3 == 2) image = testing::left_handed(image);
    const Result result = image_to_mesh(image, random_options(random));
    testing::expect_valid(image, result);
    testing::expect_bounded(result);
    testing::expect_complete(image, result);
    testing::expect_manifold(result);
    if (is_fine(image, result.options)) testing::expect_in_place(image, result);
  }
}

}  // namespace
}  // namespace anatomesh
