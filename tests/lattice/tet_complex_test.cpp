#include "lattice/tet_complex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/vec.h"
#include "lattice/leaf_mesh.h"
#include "mesh/mesh_checks.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// What make_complex says, by a list of all faces.
void expect_true(const TetComplex& complex) {
  const auto& tets = complex.mesh.tets;
  std::vector<std::vector<TetId>> at_vertex(complex.mesh.points_mm.size());
  for (TetId t = 0; t < tets.size(); ++t) {
    for (const VertexId v : tets[t]) at_vertex[v].push_back(t);
  }
  ASSERT_EQ(complex.tets_of_vertex.size(), at_vertex.size());
  for (std::size_t v = 0; v < at_vertex.size(); ++v)
    EXPECT_TRUE(std::ranges::equal(complex.tets_of_vertex[v], at_vertex[v])) << "vertex " << v;
  std::vector<std::vector<TetId>> expected(tets.size()), behind(tets.size());
  for (const auto& face : testing::all_faces(tets)) {
    for (const std::size_t t : face.tets) {
      const std::size_t other = face.tets.size() == 1 ? t : face.tets[0] + face.tets[1] - t;
      expected[t].push_back(static_cast<TetId>(other));
    }
  }
  for (TetId t = 0; t < tets.size(); ++t) {
    behind[t].assign(complex.behind[t].begin(), complex.behind[t].end());
    std::ranges::sort(behind[t]);
    std::ranges::sort(expected[t]);
    EXPECT_EQ(behind[t], expected[t]) << "tetrahedron " << t;
  }
}

void expect_same(const TetComplex& a, const TetComplex& b) {
  EXPECT_EQ(a.tets_of_vertex.begin, b.tets_of_vertex.begin);
  EXPECT_EQ(a.tets_of_vertex.items, b.tets_of_vertex.items);
  EXPECT_EQ(a.behind, b.behind);
}

/// The lattice over an image, refined and relabelled at random from round to round.
class ChangingLattice {
 public:
  ChangingLattice(const LabelImage& image, unsigned seed)
      : image_(make_tissue_image(image)),
        lattice_({6, 6, 6}, 3),
        votes_(image_, lattice_, image_.centre_mm(0, 0, 0) - Vec3{1, 1, 1}, 1),
        leaves_(lattice_, votes_),
        mesher_(lattice_, votes_, {}, 1),
        random_(seed) {
    leaves_.collect(NewLabels::vote);
  }

  LeafMesh mesh() { return mesher_.mesh(leaves_.list()); }

  void change() {
    std::vector<TetRef> marked;
    for (std::uint32_t i = 0; i < leaves_.list().size(); ++i) {
      const TetRef leaf = leaves_.list()[i].tet;
      if (random_() % 9 == 0) leaves_.decide(i, 0, static_cast<TissueId>(random_() % image_.labels.size()));
      if (leaf.level < 3 && random_() % 60 == 0) marked.push_back(leaf);
    }
    for (const TetRef leaf : marked) votes_.keep_voxels(leaf);
    votes_.descend(lattice_.refine(marked));
    leaves_.collect(NewLabels::inherit);
  }

 private:
  TissueImage image_;
  RedGreenLattice lattice_;
  VoxelVotes votes_;
  LabelledLeaves leaves_;
  LeafMesher mesher_;
  std::mt19937 random_;
};

/// With and without large pure background, which is in the mesh where it touches something else.
std::vector<LabelImage> images() {
  return {testing::noise(5, 3), testing::random_blobs(2),
          testing::make_image({3, 3, 3}, [](int, int, int) { return Label(1); })};
}

TEST(TetComplex, SaysWhatTouchesWhat) {
  for (const LabelImage& image : images()) {
    ChangingLattice lattice(image, 1);
    lattice.change();
    expect_true(make_complex(lattice.mesh().mesh));
  }
}

TEST(TetComplex, RemadeIsTheSameAsMadeAnew) {
  unsigned seed = 0;
  for (const LabelImage& image : images()) {
    SCOPED_TRACE("image " + std::to_string(seed));
    ChangingLattice lattice(image, ++seed);
    TetComplex complex = make_complex(lattice.mesh().mesh);
    for (int round = 0; round < 5; ++round) {
      lattice.change();
      const LeafMesh mesh = lattice.mesh();
      complex = remake_complex(complex, mesh.mesh, mesh.from);
      expect_same(complex, make_complex(mesh.mesh));
    }
  }
}

TEST(TetComplex, PiecesHangTogetherByFaces) {
  ChangingLattice lattice(testing::noise(8, 3), 4);
  lattice.change();
  const TetComplex complex = make_complex(lattice.mesh().mesh);
  const Pieces pieces = find_pieces(complex);
  std::vector<std::uint32_t> expected(complex.mesh.tets.size(), Pieces::kNone);
  std::uint32_t found = 0;
  for (TetId first = 0; first < expected.size(); ++first) {
    if (complex.tissue(first) == 0 || expected[first] != Pieces::kNone) continue;
    std::vector<TetId> reached = {first};
    expected[first] = found;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const TetId other : complex.behind[reached[i]]) {
        if (expected[other] != Pieces::kNone || complex.tissue(other) != complex.tissue(first)) continue;
        expected[other] = found;
        reached.push_back(other);
      }
    }
    ASSERT_LT(found, pieces.list.size());
    EXPECT_EQ(pieces.list[found].tissue, complex.tissue(first));
    EXPECT_EQ(pieces.list[found].tets, reached.size());
    EXPECT_EQ(pieces.list[found].first, first);
    ++found;
  }
  EXPECT_EQ(pieces.list.size(), found);
  EXPECT_EQ(pieces.of_tet, expected);
}

}  // namespace
}  // namespace anatomesh
