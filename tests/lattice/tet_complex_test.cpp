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

/// What a complex says, by a list of all faces. Those that are gone are of no vertex.
void expect_true(const TetComplex& complex, const std::vector<char>& gone) {
  auto tets = complex.mesh.tets;
  std::vector<std::vector<TetId>> at_vertex(complex.mesh.points_mm.size());
  for (TetId t = 0; t < tets.size(); ++t) {
    const VertexId alone = static_cast<VertexId>(at_vertex.size()) + 4 * t;
    if (gone[t]) tets[t] = {alone, alone + 1, alone + 2, alone + 3};
    for (const VertexId v : complex.mesh.tets[t]) {
      if (!gone[t]) at_vertex[v].push_back(t);
    }
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
    refine(mark_and_decide());
    leaves_.collect(NewLabels::inherit);
  }

  /// Changes the lattice, and the mesh with it. Returns the tetrahedra that are gone.
  std::vector<TetId> replace(TissueMesh& mesh, std::vector<LeafMesh::Origin>& origins) {
    const std::vector<TetRef> marked = mark_and_decide();
    std::vector<std::uint32_t> touched = decided_;
    std::vector<TetRef> renewed;
    const std::vector<TetRef> refined = refine(marked, &renewed);
    const std::vector<std::uint32_t> replaced = leaves_.replace(refined, renewed);
    touched.insert(touched.end(), replaced.begin(), replaced.end());
    std::ranges::sort(touched);
    touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
    return mesher_.update(leaves_.list(), touched, mesh, origins);
  }

  TissueId tissue(LeafMesh::Origin origin) const { return leaves_.list()[origin.leaf].votes[origin.part].tissue; }

  TissueMesh mesh_anew() {
    leaves_.collect(NewLabels::inherit);
    return LeafMesher(lattice_, votes_, {}, 1).mesh(leaves_.list()).mesh;
  }

 private:
  std::vector<TetRef> mark_and_decide() {
    std::vector<TetRef> marked;
    decided_.clear();
    for (std::uint32_t i = 0; i < leaves_.list().size(); ++i) {
      if (leaves_.list()[i].gone) continue;
      const TetRef leaf = leaves_.list()[i].tet;
      if (random_() % 9 == 0) {
        leaves_.decide(i, 0, static_cast<TissueId>(random_() % image_.labels.size()));
        decided_.push_back(i);
      }
      if (leaf.level < 3 && random_() % 60 == 0) marked.push_back(leaf);
    }
    return marked;
  }

  std::vector<TetRef> refine(const std::vector<TetRef>& marked, std::vector<TetRef>* renewed = nullptr) {
    for (const TetRef leaf : marked) {
      const std::vector<TetRef> known = votes_.keep_voxels(leaf);
      if (renewed) renewed->insert(renewed->end(), known.begin(), known.end());
    }
    const std::vector<TetRef> refined = lattice_.refine(marked);
    votes_.descend(refined);
    return refined;
  }

  TissueImage image_;
  RedGreenLattice lattice_;
  VoxelVotes votes_;
  LabelledLeaves leaves_;
  LeafMesher mesher_;
  std::mt19937 random_;
  std::vector<std::uint32_t> decided_;
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
    const TetComplex complex = make_complex(lattice.mesh().mesh);
    expect_true(complex, std::vector<char>(complex.mesh.tets.size(), 0));
  }
}

TEST(TetComplex, IsTrueAfterReplacements) {
  unsigned seed = 0;
  for (const LabelImage& image : images()) {
    SCOPED_TRACE("image " + std::to_string(seed));
    ChangingLattice lattice(image, ++seed);
    LeafMesh first = lattice.mesh();
    TetComplex complex = make_complex(std::move(first.mesh));
    std::vector<char> gone(complex.mesh.tets.size(), 0);
    for (int round = 0; round < 5; ++round) {
      const auto added = static_cast<TetId>(complex.mesh.tets.size());
      const std::vector<TetId> dropped = lattice.replace(complex.mesh, first.origins);
      replace_tets(complex, dropped, added);
      gone.resize(complex.mesh.tets.size(), 0);
      for (const TetId t : dropped) gone[t] = 1;
      expect_true(complex, gone);
    }
  }
}

using Cell = std::pair<std::vector<std::array<double, 3>>, TissueId>;

/// The tetrahedra that are not gone, by their corners.
std::vector<Cell> cells_of(const TissueMesh& mesh, const std::vector<char>& gone) {
  std::vector<Cell> cells;
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    if (gone[t]) continue;
    Cell cell = {{}, mesh.tissues[t]};
    for (const VertexId v : mesh.tets[t])
      cell.first.push_back({mesh.points_mm[v].x, mesh.points_mm[v].y, mesh.points_mm[v].z});
    cells.push_back(std::move(cell));
  }
  std::ranges::sort(cells);
  return cells;
}

TEST(LeafMesher, UpdatedMeshIsTheSameAsMadeAnew) {
  unsigned seed = 10;
  for (const LabelImage& image : images()) {
    SCOPED_TRACE("image " + std::to_string(seed));
    ChangingLattice lattice(image, ++seed);
    LeafMesh updated = lattice.mesh();
    std::vector<char> gone(updated.mesh.tets.size(), 0);
    for (int round = 0; round < 5; ++round) {
      const std::vector<TetId> dropped = lattice.replace(updated.mesh, updated.origins);
      gone.resize(updated.mesh.tets.size(), 0);
      for (const TetId t : dropped) gone[t] = 1;
      for (TetId t = 0; t < gone.size(); ++t) updated.mesh.tissues[t] = lattice.tissue(updated.origins[t]);
    }
    const TissueMesh anew = lattice.mesh_anew();
    EXPECT_EQ(cells_of(updated.mesh, gone), cells_of(anew, std::vector<char>(anew.tets.size(), 0)));
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
