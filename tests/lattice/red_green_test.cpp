#include "lattice/red_green.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "lattice/lattice_mesh.h"
#include "mesh/expect_sound.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

using testing::LatticeMesh;
using testing::leaves_of;
using testing::mesh_of;

double outer_area(const LatticeMesh& mesh) { return testing::area_of(mesh.points, testing::outer_faces(mesh.tets)); }

/// Everything that a refinement must keep, against the unrefined lattice in the same units. A crack inside would add
/// to the outer area.
void expect_sound(const LatticeMesh& refined, const LatticeMesh& root) {
  testing::expect_sound(refined.points, refined.tets);
  EXPECT_NEAR(outer_area(refined), outer_area(root), 1e-9 * outer_area(root));
  const auto worst = testing::worst_shape(refined.points, refined.tets);
  const double volume = testing::worst_shape(root.points, root.tets).volume;
  EXPECT_NEAR(worst.volume, volume, 1e-9 * volume);
  testing::expect_within(worst, 30 - 1e-6, 116.57 + 1e-6, 0.58);
}

/// Refines random leaves a few times. More than one at a time, so that they meet.
RedGreenLattice randomly_refined(unsigned seed, std::array<std::int32_t, 3> cells, int max_level) {
  std::mt19937 random(seed);
  RedGreenLattice lattice(cells, max_level);
  for (int round = 0; round < 1 + static_cast<int>(seed % 4); ++round) {
    auto leaves = leaves_of(lattice);
    std::erase_if(leaves, [&](TetRef t) { return t.level == max_level; });
    if (round > 0) std::erase_if(leaves, [](TetRef t) { return t.level == 0; });  // go deep
    std::vector<TetRef> marked;
    for (std::size_t n = 0; n < 1 + seed % 5 && !leaves.empty(); ++n)
      marked.push_back(leaves[random() % leaves.size()]);
    lattice.refine(marked);
  }
  return lattice;
}

TEST(RedGreenLattice, StartsAsTwelveTetsACube) {
  const RedGreenLattice lattice({3, 2, 4}, 2);
  EXPECT_EQ(leaves_of(lattice).size(), 3u * 2u * 4u * 12u);
  const LatticeMesh mesh = mesh_of(lattice);
  expect_sound(mesh, mesh);
  EXPECT_NEAR(testing::worst_shape(mesh.points, mesh.tets).min_dihedral_deg, 60, 1e-9);
  EXPECT_NEAR(testing::worst_shape(mesh.points, mesh.tets).max_dihedral_deg, 90, 1e-9);
}

TEST(RedGreenLattice, RandomRefinementsStaySound) {
  constexpr std::array<std::array<std::int32_t, 3>, 3> kCells = {{{2, 2, 2}, {3, 1, 2}, {1, 1, 1}}};
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    const auto& cells = kCells[seed % 3];
    const int max_level = 1 + static_cast<int>(seed % 4);
    expect_sound(mesh_of(randomly_refined(seed, cells, max_level)), mesh_of(RedGreenLattice(cells, max_level)));
    if (HasFailure()) return;
  }
}

TEST(RedGreenLattice, EveryGreenPatternOccurs) {
  std::set<unsigned> seen;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const RedGreenLattice lattice = randomly_refined(seed, {2, 2, 2}, 3);
    for (const TetRef leaf : leaves_of(lattice)) {
      EXPECT_TRUE(is_green_pattern(lattice.split_edges(leaf)));
      seen.insert(lattice.split_edges(leaf));
    }
  }
  for (unsigned mask = 0; mask < 64; ++mask) EXPECT_EQ(seen.contains(mask), is_green_pattern(mask)) << mask;
}

TEST(RedGreenLattice, AllLeavesRefinedGiveTheNextLevel) {
  RedGreenLattice lattice({2, 2, 2}, 2);
  const std::size_t roots = leaves_of(lattice).size();
  lattice.refine(leaves_of(lattice));
  EXPECT_EQ(leaves_of(lattice).size(), 8 * roots);
  EXPECT_EQ(mesh_of(lattice).tets.size(), 8 * roots);
  expect_sound(mesh_of(lattice), mesh_of(RedGreenLattice({2, 2, 2}, 2)));
}

TEST(RedGreenLattice, ReportsWhatItRefinedParentsFirst) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    RedGreenLattice lattice = randomly_refined(seed, {2, 2, 2}, 4);
    const auto before = leaves_of(lattice);
    std::set<std::pair<int, std::uint32_t>> leaves;
    for (const TetRef t : before) leaves.insert({t.level, t.slot});
    const auto deepest = *std::find_if(before.rbegin(), before.rend(), [](TetRef t) { return t.level < 4; });
    for (const TetRef t : lattice.refine({deepest})) {
      EXPECT_EQ(leaves.erase({t.level, t.slot}), 1u) << "refined twice, or before its parent";
      EXPECT_TRUE(lattice.is_refined(t));
      for (const TetRef child : lattice.children(t)) leaves.insert({child.level, child.slot});
    }
    for (const auto& [level, slot] : leaves) EXPECT_TRUE(lattice.is_leaf({level, slot}));
    EXPECT_EQ(leaves.size(), leaves_of(lattice).size());
  }
}

TEST(RedGreenLattice, RefinedTetsArePassedOver) {
  RedGreenLattice lattice({2, 2, 2}, 2);
  const TetRef first = leaves_of(lattice).front();
  EXPECT_FALSE(lattice.refine({first, first}).empty());
  EXPECT_TRUE(lattice.refine({first}).empty());
}

TEST(RedGreenLattice, FindsExactlyWhatExists) {
  const RedGreenLattice lattice = randomly_refined(7, {2, 2, 2}, 3);
  for (int level = 0; level <= 3; ++level) {
    for (const TetRef t : lattice.tets_of_level(level)) {
      TetRef found;
      EXPECT_TRUE(lattice.find(level, lattice.barycentre(t), found));
      EXPECT_EQ(found, t);
    }
  }
  TetRef found;
  EXPECT_FALSE(lattice.find(0, {-3, 2, 0}, found));
  EXPECT_FALSE(lattice.find(0, {1, 2, 8}, found));
}

// Closing by refinement alone once ran on through the whole lattice.
TEST(RedGreenLattice, RefinementStaysWhereItWasAskedFor) {
  for (int level = 0; level < 3; ++level) {
    for (int local = 0; local < kTetsPerCell; ++local) {
      RedGreenLattice lattice({12, 12, 12}, 3);
      LatticePoint target = bcc_from_local({6, 6, 6}, local);
      TetRef t;
      ASSERT_TRUE(lattice.find(0, target, t));
      for (int above = 0; above < level; ++above) {
        lattice.refine({t});
        t = lattice.children(t)[4];
      }
      EXPECT_LE(lattice.refine({t}).size(), 20u) << "level " << level << ", tetrahedron " << local;
    }
  }
}

TEST(RedGreenLattice, RefiningToTheBottomAtOnePointStaysLocal) {
  RedGreenLattice lattice({10, 10, 10}, 4);
  const Vec3 point = {21.3, 20.2, 19.9};
  for (int level = 0; level < 4; ++level) {
    const double scale = 1 << level;
    TetRef t;
    ASSERT_TRUE(lattice.find(level, bcc_locate({scale * point.x, scale * point.y, scale * point.z}), t));
    lattice.refine({t});
  }
  EXPECT_LE(leaves_of(lattice).size(), 12000u + 8 * 4 * 20);
  expect_sound(mesh_of(lattice), mesh_of(RedGreenLattice({10, 10, 10}, 4)));
}

}  // namespace
}  // namespace anatomesh
