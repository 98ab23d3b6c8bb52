#include "mesh/tissue_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "base/vec.h"
#include "mesh/cube_mesh.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

/// Corners and tissue of every tetrahedron, whatever the order.
auto content_of(const TissueMesh& mesh) {
  std::multiset<std::pair<TissueId, std::array<double, 12>>> content;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    std::array<double, 12> coordinates{};
    for (std::size_t n = 0; n < 12; ++n) coordinates[n] = mesh.points_mm[mesh.tets[t][n / 3]][n % 3];
    content.insert({mesh.tissues[t], coordinates});
  }
  return content;
}

TEST(WithCushionLast, OrdersTetsAndVertices) {
  TissueMesh mesh = testing::cube_mesh({4, 3, 3}, [](int i, int j, int k) { return (i + 2 * j + k) % 3; });
  mesh.points_mm.push_back({100, 100, 100});  // of no tetrahedron
  const TissueMesh sorted = with_cushion_last(mesh);
  EXPECT_EQ(content_of(sorted), content_of(mesh));
  EXPECT_EQ(sorted.points_mm.size(), mesh.points_mm.size() - 1);
  const auto cushion = std::find(sorted.tissues.begin(), sorted.tissues.end(), TissueId{0});
  EXPECT_TRUE(std::all_of(cushion, sorted.tissues.end(), [](TissueId t) { return t == 0; }));
  std::set<VertexId> of_tissues;
  for (std::size_t t = 0; sorted.tissues[t] != 0; ++t) of_tissues.insert(sorted.tets[t].begin(), sorted.tets[t].end());
  EXPECT_EQ(*of_tissues.rbegin() + 1, of_tissues.size());
}

TEST(WithCushionLast, KeepsTheOrderWithin) {
  const TissueMesh mesh = testing::cube_mesh({3, 1, 1}, [](int i, int, int) { return i == 1 ? 0 : i + 1; });
  const TissueMesh sorted = with_cushion_last(mesh);
  const auto corner = [](const TissueMesh& m, std::size_t t) { return m.points_mm[m.tets[t][0]]; };
  for (std::size_t t = 0; t < 6; ++t) {
    EXPECT_EQ(corner(sorted, t), corner(mesh, t));
    EXPECT_EQ(corner(sorted, t + 6), corner(mesh, t + 12));
    EXPECT_EQ(corner(sorted, t + 12), corner(mesh, t + 6));
  }
}

TEST(InSpatialOrder, IsAPermutationWithTheCushionLast) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-3, 8);
  TissueMesh mesh;
  for (int n = 0; n < 300; ++n) mesh.points_mm.push_back({number(random), number(random), 2});  // flat
  for (VertexId t = 0; t < 1000; ++t) {
    mesh.tets.push_back({t % 300, (t * 7 + 1) % 300, (t * 11 + 2) % 300, (t * 13 + 3) % 300});
    mesh.tissues.push_back(static_cast<TissueId>(t % 3));
  }
  const TissueMesh sorted = in_spatial_order(mesh);
  EXPECT_EQ(content_of(sorted), content_of(mesh));
  EXPECT_TRUE(std::ranges::is_sorted(sorted.tissues, {}, [](TissueId t) { return t == 0; }));
  double before = 0, after = 0;  // from each tetrahedron's first corner to the next one's
  for (std::size_t t = 1; t < mesh.tets.size(); ++t) {
    before += norm(mesh.points_mm[mesh.tets[t][0]] - mesh.points_mm[mesh.tets[t - 1][0]]);
    after += norm(sorted.points_mm[sorted.tets[t][0]] - sorted.points_mm[sorted.tets[t - 1][0]]);
  }
  EXPECT_LT(after, before);
  EXPECT_TRUE(in_spatial_order(TissueMesh{}).tets.empty());
}

}  // namespace
}  // namespace anatomesh
