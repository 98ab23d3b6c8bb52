#include "lattice/mend_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "base/vec.h"
#include "lattice/lattice_mesh.h"
#include "lattice/surface_checks.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

/// A block of lattice cubes, some refined, in background, with tissues drawn for the rest: a share of them at random.
TissueMesh random_mesh(unsigned seed, int tissues, double noise) {
  std::mt19937 random(seed);
  RedGreenLattice lattice({5, 5, 5}, 1);
  std::vector<TetRef> marked;
  for (const TetRef t : testing::leaves_of(lattice)) {
    if (random() % 16 == 0) marked.push_back(t);
  }
  lattice.refine(marked);
  const auto [points, tets] = testing::mesh_of(lattice);
  TissueMesh mesh{points, tets, {}};
  for (const auto& tet : tets) {
    Vec3 low = points[tet[0]], high = low;
    for (const VertexId v : tet) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], points[v][a]);
        high[a] = std::max(high[a], points[v][a]);
      }
    }
    const bool outer = std::min({low.x, low.y, low.z}) < 8 || std::max({high.x, high.y, high.z}) > 32;
    const bool noisy = static_cast<double>(random() % 1000) < 1000 * noise;
    const auto drawn = static_cast<TissueId>(random() % static_cast<unsigned>(tissues + 1));
    const TissueId smooth = low.x + high.x < 40 ? 1 : static_cast<TissueId>(tissues);
    mesh.tissues.push_back(outer ? TissueId{0} : noisy ? drawn : smooth);
  }
  return mesh;
}

std::set<VertexId> expected_singular(const TissueMesh& mesh) {
  const auto faces = testing::all_faces(mesh.tets);
  std::set<VertexId> singular;
  for (TissueId tissue = 0; tissue < 8; ++tissue) {
    const auto of_tissue = testing::singular_vertices_of(faces, [&](std::size_t t) {
      return (mesh.tissues[t] == 0) == (tissue == 0) && (tissue == 0 || mesh.tissues[t] == tissue);
    });
    singular.insert(of_tissue.begin(), of_tissue.end());
  }
  return singular;
}

/// Vertices on the border of the mesh, where the background's surface is the border itself.
std::set<VertexId> border_of(const TissueMesh& mesh) {
  std::set<VertexId> border;
  for (const auto& face : testing::outer_faces(mesh.tets)) border.insert(face.begin(), face.end());
  return border;
}

std::vector<std::size_t> pieces_by_tissue(const TissueMesh& mesh, TissueId tissues) {
  const auto faces = testing::all_faces(mesh.tets);
  std::vector<std::size_t> pieces;
  for (TissueId tissue = 1; tissue <= tissues; ++tissue)
    pieces.push_back(
        testing::pieces_of(faces, mesh.tets.size(), [&](std::size_t t) { return mesh.tissues[t] == tissue; }));
  return pieces;
}

TEST(MendSurfaces, SingularVerticesAreThoseOfTheSurfaces) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    const TissueMesh mesh = random_mesh(seed, 1 + static_cast<int>(seed % 4), seed < 3 ? 1.0 : 0.05);
    std::set<VertexId> expected = expected_singular(mesh);
    for (const VertexId v : border_of(mesh)) expected.erase(v);
    const auto found = singular_vertices(make_complex(mesh));
    EXPECT_FALSE(found.empty());
    EXPECT_EQ(std::set<VertexId>(found.begin(), found.end()), expected);
  }
}

TEST(MendSurfaces, PiecesAreThoseOfAFlood) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const TissueMesh mesh = random_mesh(seed, 3, 0.5);
    const Pieces pieces = find_pieces(make_complex(mesh));
    std::vector<std::size_t> counts(3, 0);
    for (const auto& piece : pieces.list) ++counts[piece.tissue - 1u];
    EXPECT_EQ(counts, pieces_by_tissue(mesh, 3));
  }
}

// Where price is no object.
TEST(MendSurfaces, RelabellingKeepsThePieces) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    TetComplex complex = make_complex(random_mesh(seed, 2, 0.1));
    const TissueMesh before = complex.mesh;
    Pieces pieces = find_pieces(complex);
    std::vector<TetId> changed;
    const auto open = singular_vertices(complex);
    const auto left = mend_single_tets(
        complex, pieces, open, [](TetId, TissueId) { return 0.0; }, 1, changed);
    EXPECT_LT(left.size(), open.size() / 2);
    EXPECT_EQ(left, singular_vertices(complex));
    EXPECT_EQ(pieces_by_tissue(complex.mesh, 2), pieces_by_tissue(before, 2));
    const std::set<TetId> listed(changed.begin(), changed.end());
    for (TetId t = 0; t < before.tissues.size(); ++t) {
      if (!listed.count(t)) {
        EXPECT_EQ(complex.mesh.tissues[t], before.tissues[t]);
      }
    }
  }
}

TEST(MendSurfaces, LeavesWhatIsTooDear) {
  TetComplex complex = make_complex(random_mesh(1, 2, 0.1));
  const auto before = complex.mesh.tissues;
  Pieces pieces = find_pieces(complex);
  std::vector<TetId> changed;
  mend_single_tets(
      complex, pieces, singular_vertices(complex), [](TetId, TissueId) { return 2.0; }, 1, changed);
  EXPECT_TRUE(changed.empty());
  EXPECT_EQ(complex.mesh.tissues, before);
}

TEST(MendSurfaces, NeighbourhoodsTakeOneTissue) {
  TetComplex complex = make_complex(random_mesh(2, 2, 0.02));
  Pieces pieces = find_pieces(complex);
  const std::vector<float> sizes(complex.mesh.tets.size(), 1);
  const auto singular = singular_vertices(complex);
  ASSERT_FALSE(singular.empty());
  std::vector<TetId> changed;
  mend_neighbourhoods(complex, pieces, singular, Reach::any, sizes, complex.mesh.tets.size(), changed);
  for (const VertexId v : singular) {
    const auto star = complex.tets_of_vertex[v];
    EXPECT_TRUE(
        std::all_of(star.begin(), star.end(), [&](TetId t) { return complex.tissue(t) == complex.tissue(star[0]); }));
    EXPECT_EQ(star_defect(complex, v), 0u);
  }
}

/// Bricks that change along x, each in two quarters of the block that touch along its axis only.
TissueMesh bricks_around_a_line() {
  const RedGreenLattice lattice({12, 5, 5}, 1);
  const auto [points, tets] = testing::mesh_of(lattice);
  TissueMesh mesh{points, tets, {}};
  for (const auto& tet : tets) {
    Vec3 sum{};
    for (const VertexId v : tet) sum = sum + points[v];
    const bool first = std::abs(sum.y - 4 * 20) > std::abs(sum.z - 4 * 20);
    const double brick = std::floor((sum.x / 4 + (first ? 0 : 12)) / 24);
    mesh.tissues.push_back(static_cast<TissueId>(1 + 2 * brick + (first ? 0 : 1)));
  }
  return mesh;
}

TEST(MendSurfaces, NoTissueCreepsAlongALine) {
  TetComplex complex = make_complex(bricks_around_a_line());
  const auto before = complex.mesh.tissues;
  Pieces pieces = find_pieces(complex);
  const std::vector<float> sizes(complex.mesh.tets.size(), 1);
  std::vector<VertexId> on_line;
  for (const VertexId v : singular_vertices(complex)) {
    const Vec3 p = complex.mesh.points_mm[v];
    if (std::abs(p.y - 20) < 8 && std::abs(p.z - 20) < 8) on_line.push_back(v);
  }
  ASSERT_GT(on_line.size(), 8u);
  std::vector<TetId> changed;
  mend_neighbourhoods(complex, pieces, on_line, Reach::one_tissue, sizes, before.size(), changed);
  EXPECT_FALSE(changed.empty());
  std::set<TissueId> takers;
  for (const TetId t : changed) {
    takers.insert(complex.tissue(t));
    const auto had_it = [&](VertexId v) {
      return std::ranges::any_of(complex.tets_of_vertex[v], [&](TetId o) { return before[o] == complex.tissue(t); });
    };
    EXPECT_TRUE(std::ranges::any_of(complex.mesh.tets[t], had_it)) << t;
  }
  EXPECT_GT(takers.size(), 1u);
}

}  // namespace
}  // namespace anatomesh
