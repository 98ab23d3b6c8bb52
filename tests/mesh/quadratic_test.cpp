#include "anatomesh/quadratic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anatomesh/interfaces.h"
#include "base/vec.h"
#include "mesh/cube_mesh.h"
#include "mesh/curved_shape.h"
#include "mesh/surface_bends.h"

namespace anatomesh {
namespace {

constexpr double kRadius = 10;

/// A ball of radius 10 around 0 in a cube of cubes: the outermost layer is squeezed onto the sphere.
TetMesh ball() {
  constexpr int kCubes = 6;
  const TissueMesh cubes = testing::cube_mesh({kCubes, kCubes, kCubes}, [](int, int, int) { return 1; });
  TetMesh mesh{cubes.points_mm, cubes.tets, {}};
  mesh.labels.assign(cubes.tissues.begin(), cubes.tissues.end());
  const Vec3 middle = {kCubes / 2.0, kCubes / 2.0, kCubes / 2.0};
  for (Vec3& p : mesh.points_mm) {
    const Vec3 q = p - middle;
    const double reach = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
    if (reach > 0) p = kRadius * reach / (kCubes / 2.0) / norm(q) * q;
  }
  return mesh;
}

CurvedTet tet_at(const TetMesh& mesh, std::size_t t) {
  CurvedTet tet;
  for (std::size_t n = 0; n < 4; ++n) tet.corners[n] = mesh.points_mm[mesh.tets[t][n]];
  for (std::size_t n = 0; n < 6; ++n) tet.edge_nodes[n] = mesh.points_mm[mesh.edge_nodes[t][n]];
  return tet;
}

TEST(QuadraticMesh, EveryEdgeHasOneNode) {
  const TetMesh mesh = quadratic_mesh(ball());
  ASSERT_EQ(mesh.edge_nodes.size(), mesh.tets.size());
  std::map<std::set<VertexId>, VertexId> node_of;
  std::set<VertexId> nodes;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t e = 0; e < 6; ++e) {
      const VertexId node = mesh.edge_nodes[t][e];
      const std::set edge = {mesh.tets[t][kEdgeNodeCorners[e][0]], mesh.tets[t][kEdgeNodeCorners[e][1]]};
      EXPECT_EQ(node_of.try_emplace(edge, node).first->second, node);
      nodes.insert(node);
    }
  }
  EXPECT_EQ(nodes.size(), node_of.size());
  EXPECT_EQ(mesh.points_mm.size(), ball().points_mm.size() + nodes.size());
}

Vec3 middle_of(const TetMesh& mesh, const EdgeBend& bend) {
  return 0.5 * (mesh.points_mm[bend.from] + mesh.points_mm[bend.to]);
}

TEST(SurfaceBends, LeadToTheSphere) {
  const TetMesh mesh = ball();
  const std::vector<EdgeBend> bends = surface_bends(mesh);
  std::set<std::pair<VertexId, VertexId>> edges;
  for (const Interface& skin : interfaces_of(mesh)) {
    for (const TetFace face : skin.faces) {
      const auto corners = corners_of(mesh, face);
      for (std::size_t n = 0; n < 3; ++n) edges.insert(std::minmax(corners[n], corners[(n + 1) % 3]));
    }
  }
  EXPECT_EQ(bends.size(), edges.size());
  double worst = 0, worst_chord = 0;
  for (const EdgeBend& bend : bends) {
    worst_chord = std::max(worst_chord, kRadius - norm(middle_of(mesh, bend)));
    worst = std::max(worst, std::abs(kRadius - norm(middle_of(mesh, bend) + bend.bow_mm)));
  }
  EXPECT_GT(worst_chord, 0.2);
  EXPECT_LT(worst, 0.05 * worst_chord);
}

TEST(QuadraticMesh, KeepsTheBoundsOrWhatTheStraightOneHas) {
  const TetMesh straight = ball();
  const CurveBounds bounds = {30, 120};
  const TetMesh mesh = quadratic_mesh(straight, bounds);
  const ShapeBounds cosines = ShapeBounds::from_degrees(bounds.min_dihedral_deg, bounds.max_dihedral_deg, 0);
  std::size_t curved = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const CurvedTet tet = tet_at(mesh, t);
    const auto& [a, b, c, d] = tet.corners;
    const auto before = TetGeometry(a, b, c, d).cosine_range(), after = corner_angles(tet);
    EXPECT_LE(after.largest, std::max(cosines.largest_cos, before.largest) + 1e-9);
    EXPECT_GE(after.smallest, std::min(cosines.smallest_cos, before.smallest) - 1e-9);
    EXPECT_GE(least_jacobian(tet), 0.3);
    curved += least_jacobian(tet) < 0.99;
  }
  EXPECT_GT(curved, 100u);
}

TEST(QuadraticMesh, FlatFacesAndSharpEdgesStayStraight) {
  const TissueMesh cubes = testing::cube_mesh({3, 2, 2}, [](int i, int, int) { return i == 0 ? 4 : 1; });
  TetMesh flat{cubes.points_mm, cubes.tets, {}};
  flat.labels.assign(cubes.tissues.begin(), cubes.tissues.end());
  const TetMesh mesh = quadratic_mesh(flat);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t e = 0; e < 6; ++e) {
      const Vec3 a = mesh.points_mm[mesh.tets[t][kEdgeNodeCorners[e][0]]];
      const Vec3 b = mesh.points_mm[mesh.tets[t][kEdgeNodeCorners[e][1]]];
      EXPECT_LT(norm(mesh.points_mm[mesh.edge_nodes[t][e]] - 0.5 * (a + b)), 1e-12);
    }
  }
}

TEST(SurfaceBends, LinesWhereThreeTissuesMeetBend) {
  TetMesh mesh = ball();
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    Vec3 middle;
    for (const VertexId v : mesh.tets[t]) middle += 0.25 * mesh.points_mm[v];
    mesh.labels[t] = middle.x < 0 ? 1 : 2;
  }
  std::size_t seen = 0;
  for (const EdgeBend& bend : surface_bends(mesh)) {
    const Vec3 middle = middle_of(mesh, bend);
    if (std::abs(middle.x) > 1e-9 || norm(middle) < 0.9 * kRadius) continue;
    EXPECT_NEAR(norm(middle + bend.bow_mm), kRadius, 0.02);
    ++seen;
  }
  EXPECT_EQ(seen, 24u);
}

TEST(QuadraticMesh, LinearMeshGivesTheCornersBack) {
  const TetMesh before = ball();
  const TetMesh after = linear_mesh(quadratic_mesh(before));
  EXPECT_EQ(after.points_mm, before.points_mm);
  EXPECT_EQ(after.tets, before.tets);
  EXPECT_TRUE(after.edge_nodes.empty());
}

TEST(CurvedShape, StraightTetrahedraHaveTheirOwnAngles) {
  const Vec3 a, b{1, 0, 0}, c{0, 2, 0}, d{0.3, 0.4, 1};
  CurvedTet tet{{a, b, c, d}, {}};
  for (std::size_t e = 0; e < 6; ++e) {
    tet.edge_nodes[e] = 0.5 * (tet.corners[kEdgeNodeCorners[e][0]] + tet.corners[kEdgeNodeCorners[e][1]]);
  }
  EXPECT_NEAR(least_jacobian(tet), 1, 1e-12);
  EXPECT_NEAR(corner_angles(tet).largest, TetGeometry(a, b, c, d).cosine_range().largest, 1e-12);
  EXPECT_NEAR(corner_angles(tet).smallest, TetGeometry(a, b, c, d).cosine_range().smallest, 1e-12);
}

/// Sampled determinants of the mapping are never below the bound.
TEST(CurvedShape, LeastJacobianIsALowerBound) {
  const Vec3 a, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
  CurvedTet tet{{a, b, c, d}, {}};
  for (std::size_t e = 0; e < 6; ++e) {
    const double off = 0.05 * static_cast<double>(e);
    tet.edge_nodes[e] = 0.5 * (tet.corners[kEdgeNodeCorners[e][0]] + tet.corners[kEdgeNodeCorners[e][1]]) +
                        Vec3{off, -0.5 * off, 0.3 * off};
  }
  const auto place = [&](std::array<double, 4> l) {
    Vec3 p;
    for (std::size_t n = 0; n < 4; ++n) p += l[n] * (2 * l[n] - 1) * tet.corners[n];
    for (std::size_t e = 0; e < 6; ++e) {
      p += 4 * l[kEdgeNodeCorners[e][0]] * l[kEdgeNodeCorners[e][1]] * tet.edge_nodes[e];
    }
    return p;
  };
  constexpr double kStep = 1e-5;
  double least = 1;
  for (int i = 0; i <= 8; ++i) {
    for (int j = 0; i + j <= 8; ++j) {
      for (int k = 0; i + j + k <= 8; ++k) {
        const std::array l = {1 - (i + j + k) / 8.0, i / 8.0, j / 8.0, k / 8.0};
        std::array<Vec3, 3> slope;
        for (std::size_t n = 0; n < 3; ++n) {
          auto there = l, before = l;
          there[0] -= kStep, there[n + 1] += kStep, before[0] += kStep, before[n + 1] -= kStep;
          slope[n] = 0.5 / kStep * (place(there) - place(before));
        }
        least = std::min(least, dot(cross(slope[0], slope[1]), slope[2]));
      }
    }
  }
  EXPECT_LE(least_jacobian(tet), least + 1e-6);
  EXPECT_GT(least_jacobian(tet), least - 0.3);
  EXPECT_LT(least, 0.95);
}

}  // namespace
}  // namespace anatomesh
