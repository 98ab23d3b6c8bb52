#include "lattice/clean_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lattice/lattice_mesh.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

/// A box of lattice cubes: tissue 1 left of the middle, 2 right of it, by the tetrahedra's centres.
TissueMesh halves() {
  const RedGreenLattice lattice({6, 4, 4}, 0);
  const auto [points, tets] = testing::mesh_of(lattice);
  TissueMesh mesh{points, tets, {}};
  for (const auto& tet : tets) {
    double x = 0;
    for (const VertexId v : tet) x += 0.25 * points[v].x;
    mesh.tissues.push_back(x < 12 ? 1 : 2);
  }
  return mesh;
}

/// Tetrahedra behind the faces of each.
std::vector<std::vector<std::size_t>> neighbours_of(const TissueMesh& mesh) {
  std::vector<std::vector<std::size_t>> neighbours(mesh.tets.size());
  for (const auto& face : testing::all_faces(mesh.tets)) {
    if (face.tets.size() < 2) continue;
    neighbours[face.tets[0]].push_back(face.tets[1]);
    neighbours[face.tets[1]].push_back(face.tets[0]);
  }
  return neighbours;
}

bool always(TetId) { return true; }

TEST(CleanLabels, SmoothHalvesStay) {
  TissueMesh mesh = halves();
  const auto before = mesh.tissues;
  clean_labels(mesh, always);
  EXPECT_EQ(mesh.tissues, before);
}

TEST(CleanLabels, LoneTetsGoBackToTheirSurroundings) {
  const TissueMesh clean = halves();
  for (std::size_t t = 0; t < clean.tets.size(); ++t) {
    const auto corners = testing::corners_of(clean.points_mm, clean.tets[t]);
    const bool far_from_borders = std::all_of(corners.begin(), corners.end(), [](Vec3 p) {
      return std::abs(p.x - 12) > 3 && std::min({p.x, p.y, p.z, 24 - p.x, 16 - p.y, 16 - p.z}) > 3;
    });
    if (!far_from_borders) continue;
    TissueMesh mesh = clean;
    mesh.tissues[t] = static_cast<TissueId>(3 - mesh.tissues[t]);
    clean_labels(mesh, always);
    EXPECT_EQ(mesh.tissues, clean.tissues) << t;
  }
}

TEST(CleanLabels, SmallTissuesStay) {
  TissueMesh mesh = halves();
  mesh.tissues[mesh.tissues.size() / 4] = 3;
  const auto before = mesh.tissues;
  clean_labels(mesh, always);
  EXPECT_EQ(mesh.tissues, before);
}

TEST(CleanLabels, KeepsWhatMayNotChange) {
  TissueMesh mesh = halves();
  std::mt19937 random(3);
  for (TissueId& tissue : mesh.tissues) tissue = static_cast<TissueId>(random() % 3);
  const auto before = mesh.tissues;
  clean_labels(mesh, [](TetId) { return false; });
  EXPECT_EQ(mesh.tissues, before);
  clean_labels(mesh, [](TetId t) { return t % 2 == 0; });
  for (std::size_t t = 1; t < before.size(); t += 2) EXPECT_EQ(mesh.tissues[t], before[t]);
  EXPECT_NE(mesh.tissues, before);
}

TEST(CleanLabels, LeavesFewerTetsThatStickOut) {
  TissueMesh mesh = halves();
  std::mt19937 random(4);
  for (TissueId& tissue : mesh.tissues) {
    if (random() % 5 == 0) tissue = static_cast<TissueId>(random() % 3);
  }
  const auto neighbours = neighbours_of(mesh);
  const auto sticking_out = [&] {
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      const auto alike = std::count_if(neighbours[t].begin(), neighbours[t].end(),
                                       [&](std::size_t m) { return mesh.tissues[m] == mesh.tissues[t]; });
      count += alike <= 1 && neighbours[t].size() == 4;
    }
    return count;
  };
  const std::size_t before = sticking_out();
  clean_labels(mesh, always);
  EXPECT_LT(sticking_out(), before / 2);
}

}  // namespace
}  // namespace anatomesh
