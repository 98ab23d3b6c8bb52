#include "deform/angle_guard.h"

#include <gtest/gtest.h>

#include <random>

#include "base/parallel.h"
#include "base/vec.h"
#include "deform/lattice_of.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

constexpr double kMinDeg = 18, kMaxDeg = 148, kMinMeanRatio = 0.35;
const ShapeBounds kBounds = ShapeBounds::from_degrees(kMinDeg, kMaxDeg, kMinMeanRatio);

/// A mesh under guard.
struct Guarded {
  explicit Guarded(const LabelImage& image)
      : mesh(testing::lattice_of(make_tissue_image(image))), topology(make_topology(mesh)) {}

  TissueMesh mesh;
  MeshTopology topology;
  AngleGuard guard{mesh, topology, kBounds};
};

void expect_bounds(const TissueMesh& mesh) {
  const auto worst = testing::worst_tissue_shape(mesh);
  EXPECT_GE(worst.min_dihedral_deg, kMinDeg);
  EXPECT_LE(worst.max_dihedral_deg, kMaxDeg);
  EXPECT_GE(worst.mean_ratio, kMinMeanRatio);
  EXPECT_GT(testing::smallest_volume(mesh.points_mm, mesh.tets), 0);
}

class RandomMoves {
 public:
  RandomMoves(const TissueMesh& mesh, unsigned seed) : mesh_(mesh), random_(seed) {}

  VertexId vertex() { return static_cast<VertexId>(random_() % mesh_.points_mm.size()); }
  Vec3 goal(VertexId v, double reach) {
    std::uniform_real_distribution<double> step(-reach, reach);
    const double x = step(random_), y = step(random_), z = step(random_);
    return mesh_.points_mm[v] + Vec3{x, y, z};
  }

 private:
  const TissueMesh& mesh_;
  std::mt19937 random_;
};

TEST(AngleGuard, BoundsHoldWhateverIsAskedFor) {
  for (const LabelImage& image : {testing::sphere(5), testing::four_label_point(), testing::noise(2)}) {
    Guarded g(image);
    RandomMoves moves(g.mesh, 1);
    for (int round = 0; round < 10; ++round) {
      for (int n = 0; n < 1000; ++n) {
        const VertexId v = moves.vertex();
        g.guard.advance(v, moves.goal(v, 1 + round), n % 5);
      }
      expect_bounds(g.mesh);
    }
  }
}

TEST(AngleGuard, GoesTheShareThatItSays) {
  Guarded g(testing::sphere(5));
  RandomMoves moves(g.mesh, 2);
  int whole = 0, part = 0, none = 0;
  for (int n = 0; n < 2000; ++n) {
    const VertexId v = moves.vertex();
    const Vec3 from = g.mesh.points_mm[v], goal = moves.goal(v, 2);
    const double share = g.guard.advance(v, goal, 3);
    EXPECT_LT(norm(g.mesh.points_mm[v] - (from + share * (goal - from))), 1e-12);
    EXPECT_TRUE(share == 0 || share == 1 || share == 0.5 || share == 0.25 || share == 0.125);
    ++(share == 1 ? whole : share > 0 ? part : none);
  }
  EXPECT_GT(whole, 0);
  EXPECT_GT(part, 0);
  EXPECT_GT(none, 0);
}

TEST(AngleGuard, GoesNowhereWhenItCannot) {
  Guarded g(testing::sphere(5));
  for (VertexId v = 0; v < g.mesh.points_mm.size(); ++v) {
    const Vec3 from = g.mesh.points_mm[v];
    EXPECT_EQ(g.guard.advance(v, from + Vec3{1e4, -1e4, 1e4}, 3), 0);
    EXPECT_EQ(g.mesh.points_mm[v], from);
  }
}

/// Shapes of the tetrahedra at v, with v at p, against the bounds: by how many degrees (and hundredths of the mean
/// ratio) the worst one of the tissues lies inside. Far outside when a tetrahedron turns over.
double room_at(const Guarded& g, VertexId v, Vec3 p) {
  double room = 180;
  for (const TetId t : g.topology.tets_of_vertex[v]) {
    auto corners = testing::corners_of(g.mesh.points_mm, g.mesh.tets[t]);
    for (std::size_t n = 0; n < 4; ++n) {
      if (g.mesh.tets[t][n] == v) corners[n] = p;
    }
    const auto shape = testing::shape_of(corners);
    if (shape.volume <= 0) return -180;
    if (g.mesh.tissues[t] == 0) continue;
    room = std::min({room, shape.min_dihedral_deg - kMinDeg, kMaxDeg - shape.max_dihedral_deg,
                     100 * (shape.mean_ratio - kMinMeanRatio)});
  }
  return room;
}

TEST(AngleGuard, GoesWhereTheAnglesAllow) {
  Guarded g(testing::vessel_tree());
  RandomMoves moves(g.mesh, 3);
  for (int n = 0; n < 5000; ++n) {
    const VertexId v = moves.vertex();
    const Vec3 from = g.mesh.points_mm[v], p = moves.goal(v, 1.5);
    const double room = room_at(g, v, p);
    const bool in_tissues_only = [&] {
      for (const TetId t : g.topology.tets_of_vertex[v]) {
        if (g.mesh.tissues[t] == 0) return false;
      }
      return true;
    }();
    const double share = g.guard.advance(v, p, 0);
    g.mesh.points_mm[v] = from;
    if (room < -1e-5) {
      EXPECT_EQ(share, 0);
    } else if (room > 1e-5 && in_tissues_only) {
      EXPECT_EQ(share, 1);
    }
  }
}

TEST(AdvanceAll, ReachesNearGoals) {
  Guarded g(testing::sphere(5));
  RandomMoves moves(g.mesh, 4);
  std::vector<Vec3> goals = g.mesh.points_mm;
  for (VertexId v = 0; v < goals.size(); ++v) goals[v] = moves.goal(v, 1e-3);
  advance_all(g.mesh, g.topology, g.guard, goals, 2, testing::quiet_stage());
  EXPECT_EQ(g.mesh.points_mm, goals);
}

TEST(AdvanceAll, KeepsTheBoundsOnAnyNumberOfThreads) {
  std::vector<std::vector<Vec3>> results;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    Guarded g(testing::four_label_point());
    RandomMoves moves(g.mesh, 5);
    std::vector<Vec3> goals = g.mesh.points_mm;
    for (VertexId v = 0; v < goals.size(); ++v) goals[v] = moves.goal(v, 3);
    advance_all(g.mesh, g.topology, g.guard, goals, 3, testing::quiet_stage());
    expect_bounds(g.mesh);
    results.push_back(g.mesh.points_mm);
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(AngleGuard, AdvanceBestEndsNoFartherFromItsGoalAndKeepsTheBounds) {
  Guarded g(testing::four_label_point());
  RandomMoves moves(g.mesh, 7);
  const Mat3 identity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  int nearer = 0;
  for (int n = 0; n < 3000; ++n) {
    const VertexId v = moves.vertex();
    const Vec3 from = g.mesh.points_mm[v], goal = moves.goal(v, 3);
    g.guard.advance(v, goal, 3);
    const double plain = norm(g.mesh.points_mm[v] - goal);
    g.mesh.points_mm[v] = from;
    g.guard.advance_best(v, goal, identity, 0.4);
    nearer += norm(g.mesh.points_mm[v] - goal) < 0.9 * plain;
  }
  EXPECT_GT(nearer, 500);
  expect_bounds(g.mesh);
}

TEST(RelaxInterior, MovesInnerVerticesOnlyAndKeepsTheBounds) {
  Guarded g(testing::four_label_point());
  RandomMoves moves(g.mesh, 6);
  for (int n = 0; n < 5000; ++n) {
    const VertexId v = moves.vertex();
    g.guard.advance(v, moves.goal(v, 1), 3);
  }
  const auto before = g.mesh.points_mm;
  relax_interior(g.mesh, g.topology, g.guard, testing::quiet_stage());
  expect_bounds(g.mesh);
  int moved = 0;
  for (VertexId v = 0; v < before.size(); ++v) {
    if (g.topology.on_interface(v) || g.topology.outside(v)) {
      EXPECT_EQ(g.mesh.points_mm[v], before[v]);
    } else {
      moved += g.mesh.points_mm[v] != before[v];
    }
  }
  EXPECT_GT(moved, 10);
}

}  // namespace
}  // namespace anatomesh
