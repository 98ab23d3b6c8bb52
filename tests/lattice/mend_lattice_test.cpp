#include "lattice/mend_lattice.h"

#include <gtest/gtest.h>

#include <string>

#include "lattice/built_lattice.h"
#include "lattice/label_lattice.h"
#include "lattice/surface_checks.h"
#include "mesh/mesh_checks.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

using testing::build;
using testing::make_image;
using testing::NamedImage;
using testing::plan_for;

/// Every tissue, and all of them together (label 0: the outer surface), against the image.
void expect_whole(const TissueImage& image, const TissueMesh& mesh) {
  const auto faces = testing::all_faces(mesh.tets);
  for (TissueId t = 0; t < image.labels.size(); ++t) {
    SCOPED_TRACE("tissue " + std::to_string(t));
    const auto inside = [&](std::size_t tet) { return t == 0 ? mesh.tissues[tet] != 0 : mesh.tissues[tet] == t; };
    EXPECT_TRUE(testing::singular_vertices_of(faces, inside).empty());
    if (t > 0) {
      EXPECT_EQ(testing::pieces_of(faces, mesh.tets.size(), inside), testing::image_components_of(image, t));
    }
  }
}

std::vector<NamedImage> ambiguous_images() {
  return {
      {"voxels_at_an_edge",
       make_image({4, 4, 3}, [](int i, int j, int k) { return Label(k == 1 && i == j && i % 3 != 0); })},
      {"voxels_at_a_corner",
       make_image({4, 4, 4}, [](int i, int j, int k) { return Label(i == j && j == k && i % 3 != 0); })},
      {"diagonal_line", make_image({14, 14, 14}, [](int i, int j, int k) { return Label(i == j && j == k); })},
      {"flat_diagonal_line", make_image({14, 14, 3}, [](int i, int j, int k) { return Label(i == j && k == 1); })},
      {"line", make_image({16, 5, 5}, [](int, int j, int k) { return Label(j == 2 && k == 2); })},
      {"two_lines_apart", make_image({16, 5, 5}, [](int, int j, int k) { return Label(k == 2 && j % 2 == 1); })},
      {"crossing_diagonals", make_image({12, 12, 4},
                                        [](int i, int j, int k) {
                                          return k == 1 ? Label(i == j) : k == 2 ? 2 * Label(i + j == 11) : Label(0);
                                        })},
      {"slanted_plate", make_image({12, 12, 12}, [](int i, int j, int k) { return Label(i + j + k == 16); })},
      {"plates", make_image({12, 12, 9}, [](int, int, int k) { return Label(k % 2); })},
      {"islands",
       make_image({14, 14, 14}, [](int i, int j, int k) { return Label(i % 3 == 1 && j % 4 == 1 && k % 5 == 1); })},
      {"islands_in_a_tissue",
       make_image({14, 14, 14},
                  [](int i, int j, int k) { return Label(1 + (i % 4 == 1 && j % 4 == 1 && k % 5 == 1)); })},
      {"fine_checkerboard", testing::checkerboard(1)},
  };
}

TEST(MendLattice, EveryShapeIsWhole) {
  for (const NamedImage& named : testing::all_shapes()) {
    const TissueImage image = make_tissue_image(named.image);
    for (const double size : {8.0, 5.31, 15.7}) {
      SCOPED_TRACE(named.name + ", bcc_size_mm " + std::to_string(size));
      expect_whole(image, build(image, plan_for(image, size, 0.95)).mesh);
    }
  }
}

TEST(MendLattice, AmbiguousVoxelsHangTogether) {
  for (const NamedImage& named : ambiguous_images()) {
    const TissueImage image = make_tissue_image(named.image);
    for (const double size : {8.0, 3.7}) {
      SCOPED_TRACE(named.name + ", bcc_size_mm " + std::to_string(size));
      expect_whole(image, build(image, plan_for(image, size, 0.95)).mesh);
    }
  }
}

TEST(MendLattice, CoarseLatticesAreWhole) {
  std::vector<NamedImage> images = ambiguous_images();
  for (std::uint64_t seed = 0; seed < 3; ++seed) images.push_back({"blobs", testing::random_blobs(seed)});
  for (const NamedImage& named : images) {
    SCOPED_TRACE(named.name);
    const TissueImage image = make_tissue_image(named.image);
    expect_whole(image, build(image, plan_for(image, 16, 0.5)).mesh);
  }
}

TEST(MendLattice, NoiseIsManifold) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const TissueImage image = make_tissue_image(testing::noise(seed, 6, 1 + static_cast<int>(seed) % 4));
    expect_whole(image, build(image, plan_for(image, 8, 0.8)).mesh);
  }
}

}  // namespace
}  // namespace anatomesh
