#include "lattice/root_voxels.h"

#include <gtest/gtest.h>

#include <random>

#include "lattice/red_green.h"

namespace anatomesh {
namespace {

using Axes = std::array<std::vector<double>, 3>;

/// Offsets of the voxels in each root tetrahedron, looked up one by one.
std::vector<std::vector<std::uint32_t>> located(const Axes& position, const RedGreenLattice& lattice) {
  std::vector<std::vector<std::uint32_t>> voxels(lattice.slot_count(0));
  std::uint32_t voxel = 0;
  for (const double z : position[2]) {
    for (const double y : position[1]) {
      for (const double x : position[0]) {
        TetRef t;
        if (lattice.find(0, bcc_locate({x, y, z}), t)) voxels[t.slot].push_back(voxel);
        ++voxel;
      }
    }
  }
  return voxels;
}

void expect_sorted(const Axes& position, const std::array<std::int32_t, 3>& cells) {
  const RedGreenLattice lattice(cells, 0);
  const RootVoxels sorted = sort_into_roots(position, cells);
  const auto expected = located(position, lattice);
  ASSERT_EQ(sorted.begin.size(), expected.size() + 1);
  for (std::size_t s = 0; s < expected.size(); ++s) {
    const std::vector<std::uint32_t> voxels(sorted.order.begin() + sorted.begin[s],
                                            sorted.order.begin() + sorted.begin[s + 1]);
    EXPECT_EQ(voxels, expected[s]) << "slot " << s;
  }
}

/// count centres, `step` units apart, from `first`.
std::vector<double> axis(double first, double step, int count) {
  std::vector<double> centres;
  for (int i = 0; i < count; ++i) centres.push_back(first + step * i);
  return centres;
}

TEST(RootVoxels, AreThoseThatLocateFinds) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (int n = 0; n < 20; ++n) {
    Axes position;
    for (auto& centres : position) centres = axis(-2 + 4 * any(random), 0.3 + any(random), 17);
    expect_sorted(position, {4, 3, 5});
  }
}

TEST(RootVoxels, OnPlanesOfTheLatticeGoToOneTet) {
  for (const double step : {0.5, 1.0, 2.0}) {
    const auto centres = axis(0, step, static_cast<int>(14 / step));
    expect_sorted({centres, centres, centres}, {4, 4, 4});
  }
}

TEST(RootVoxels, OutsideTheLatticeAreLeftOut) {
  const auto centres = axis(-9, 1.1, 30);
  expect_sorted({centres, centres, centres}, {2, 3, 1});
}

}  // namespace
}  // namespace anatomesh
