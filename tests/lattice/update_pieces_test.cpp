#include "lattice/update_pieces.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "lattice/lattice_mesh.h"

namespace anatomesh {
namespace {

/// Whether two have the same pieces, whatever their numbers.
void expect_same(const Pieces& a, const Pieces& b) {
  ASSERT_EQ(a.of_tet.size(), b.of_tet.size());
  std::map<std::uint32_t, std::uint32_t> number = {{Pieces::kNone, Pieces::kNone}}, back = number;
  for (std::size_t t = 0; t < a.of_tet.size(); ++t) {
    ASSERT_EQ(number.try_emplace(a.of_tet[t], b.of_tet[t]).first->second, b.of_tet[t]) << "tetrahedron " << t;
    ASSERT_EQ(back.try_emplace(b.of_tet[t], a.of_tet[t]).first->second, a.of_tet[t]) << "tetrahedron " << t;
  }
  for (std::uint32_t p = 0; p < a.list.size(); ++p) {
    if (!number.contains(p)) {
      EXPECT_EQ(a.list[p].tets, 0u);
      continue;
    }
    EXPECT_EQ(a.list[p].tets, b.list[number[p]].tets);
    EXPECT_EQ(a.list[p].tissue, b.list[number[p]].tissue);
  }
}

TEST(UpdatePieces, AreThoseFoundAnew) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    RedGreenLattice lattice({4, 4, 4}, 1);
    lattice.refine({testing::leaves_of(lattice)[100]});
    const auto [points, corners] = testing::mesh_of(lattice);
    TetComplex complex = make_complex({points, corners, std::vector<TissueId>(corners.size())});
    const auto tets = static_cast<TetId>(complex.mesh.tets.size());
    for (TissueId& tissue : complex.mesh.tissues) {
      tissue = random() % 5 < seed ? TissueId{1} : static_cast<TissueId>(random() % 3);
    }
    Pieces pieces = find_pieces(complex);
    for (int round = 0; round < 30; ++round) {
      std::map<TetId, TissueId> changes;
      for (auto n = random() % (tets / 10); n > 0; --n)
        changes[static_cast<TetId>(random() % tets)] = static_cast<TissueId>(random() % 3);
      std::vector<TetId> changed;
      for (const auto& [t, tissue] : changes) {
        complex.mesh.tissues[t] = tissue;
        changed.push_back(t);
      }
      update_pieces(complex, pieces, changed);
      expect_same(pieces, find_pieces(complex));
    }
  }
}

}  // namespace
}  // namespace anatomesh
