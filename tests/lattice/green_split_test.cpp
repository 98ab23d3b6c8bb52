#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>
#include <set>

#include "base/vec.h"
#include "lattice/red_green.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

using testing::Corners;
using testing::Tet;

std::vector<unsigned> green_patterns() {
  std::vector<unsigned> patterns;
  for (unsigned mask = 1; mask < 64; ++mask) {
    if (is_green_pattern(mask)) patterns.push_back(mask);
  }
  return patterns;
}

std::array<std::size_t, 2> ends_of(std::size_t edge) {
  return {static_cast<std::size_t>(kTetEdges[edge][0]), static_cast<std::size_t>(kTetEdges[edge][1])};
}

/// Vertices and edge midpoints of a positive tetrahedron of the lattice.
std::array<Vec3, 10> bcc_nodes() {
  LatticePoint b = {1, 2, 0};
  if (!is_positive(b)) b = {2, 1, 0};
  std::array<Vec3, 10> nodes;
  const auto vertices = bcc_vertices(b);
  for (std::size_t v = 0; v < 4; ++v) {
    for (std::size_t a = 0; a < 3; ++a) nodes[v][a] = vertices[v][a];
  }
  for (std::size_t e = 0; e < 6; ++e) nodes[4 + e] = 0.5 * (nodes[ends_of(e)[0]] + nodes[ends_of(e)[1]]);
  return nodes;
}

std::vector<Tet> children_of(unsigned mask) {
  const GreenSplit& split = green_split(mask);
  std::vector<Tet> tets;
  for (std::size_t c = 0; c < static_cast<std::size_t>(split.count); ++c)
    tets.push_back({split.tets[c][0], split.tets[c][1], split.tets[c][2], split.tets[c][3]});
  return tets;
}

bool share_an_end(std::size_t e, std::size_t f) {
  for (const std::size_t end : ends_of(e)) {
    if (end == ends_of(f)[0] || end == ends_of(f)[1]) return true;
  }
  return false;
}

/// Whether three edges make up a face, by their ends.
bool is_face(const std::vector<std::size_t>& edges) {
  std::set<std::size_t> ends;
  for (const std::size_t e : edges) {
    for (const std::size_t end : ends_of(e)) ends.insert(end);
  }
  return edges.size() == 3 && ends.size() == 3;
}

TEST(GreenSplit, PatternsAreNoneOneTwoOppositeOrAFace) {
  for (unsigned mask = 0; mask < 64; ++mask) {
    std::vector<std::size_t> edges;
    for (std::size_t e = 0; e < 6; ++e) {
      if (mask >> e & 1) edges.push_back(e);
    }
    const bool opposite = edges.size() == 2 && !share_an_end(edges[0], edges[1]);
    EXPECT_EQ(is_green_pattern(mask), edges.size() < 2 || opposite || is_face(edges)) << mask;
  }
  EXPECT_EQ(green_patterns().size(), 6u + 3u + 4u);
}

TEST(GreenSplit, ChildrenTileTheParentAndKeepItsOrientation) {
  const auto nodes = bcc_nodes();
  const double whole = testing::shape_of({nodes[0], nodes[1], nodes[2], nodes[3]}).volume;
  ASSERT_GT(whole, 0);
  for (const unsigned mask : green_patterns()) {
    const auto children = children_of(mask);
    EXPECT_EQ(children.size(), std::popcount(mask) == 1 ? 2u : 4u) << mask;
    EXPECT_GT(testing::smallest_volume(nodes, children), 0) << mask;
    EXPECT_NEAR(testing::worst_shape(nodes, children).volume, whole, 1e-12) << mask;
    EXPECT_EQ(testing::crowded_faces(nodes, children), 0u) << mask;
  }
}

TEST(GreenSplit, UsesTheMidpointsOfTheSplitEdgesOnly) {
  for (const unsigned mask : green_patterns()) {
    unsigned used = 0;
    for (const Tet& tet : children_of(mask)) {
      for (const VertexId node : tet) used |= node < 4 ? 0 : 1u << (node - 4);
    }
    EXPECT_EQ(used, mask);
  }
}

TEST(GreenSplit, KeepsTheShapeBounds) {
  const auto nodes = bcc_nodes();
  for (const unsigned mask : green_patterns()) {
    const auto worst = testing::worst_shape(nodes, children_of(mask));
    EXPECT_GE(worst.min_dihedral_deg, 30 - 1e-9) << mask;
    EXPECT_LE(worst.max_dihedral_deg, 116.57) << mask;
    EXPECT_GE(worst.mean_ratio, 0.58) << mask;
  }
}

/// Barycentric coordinates in eighths, so that many points lie on the faces between children, and random ones.
std::vector<std::array<double, 4>> barycentric_samples() {
  std::vector<std::array<double, 4>> samples;
  for (int a = 0; a <= 8; ++a) {
    for (int b = 0; a + b <= 8; ++b) {
      for (int c = 0; a + b + c <= 8; ++c) samples.push_back({a / 8.0, b / 8.0, c / 8.0, (8 - a - b - c) / 8.0});
    }
  }
  std::mt19937 random(5);
  std::exponential_distribution<double> part;
  for (int n = 0; n < 200; ++n) {
    std::array<double, 4> weights = {part(random), part(random), part(random), part(random)};
    const double total = weights[0] + weights[1] + weights[2] + weights[3];
    for (double& w : weights) w /= total;
    samples.push_back(weights);
  }
  return samples;
}

TEST(GreenSplit, ChildAtAgreesWithContainment) {
  const auto nodes = bcc_nodes();
  for (const unsigned mask : green_patterns()) {
    const auto children = children_of(mask);
    for (const auto& weights : barycentric_samples()) {
      Vec3 p;
      for (std::size_t n = 0; n < 4; ++n) p += weights[n] * nodes[n];
      const auto chosen = static_cast<std::size_t>(green_child_at(mask, weights));
      ASSERT_LT(chosen, children.size());
      for (std::size_t c = 0; c < children.size(); ++c) {
        const double depth = testing::depth_inside(testing::corners_of(nodes, children[c]), p);
        if (depth > 1e-12) {
          EXPECT_EQ(chosen, c) << mask;
        }
        if (chosen == c) {
          EXPECT_GE(depth, -1e-12) << mask;
        }
      }
    }
  }
}

TEST(GreenSplit, ChildAtDoesNotDependOnTheScale) {
  for (const unsigned mask : green_patterns()) {
    for (const auto& w : barycentric_samples())
      EXPECT_EQ(green_child_at(mask, w), green_child_at(mask, {4 * w[0], 4 * w[1], 4 * w[2], 4 * w[3]}));
  }
}

}  // namespace
}  // namespace anatomesh
