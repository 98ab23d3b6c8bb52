#include "deform/improve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/flip_interfaces.h"
#include "deform/improve_shapes.h"
#include "deform/lattice_of.h"
#include "deform/sizes.h"
#include "deform/slide_vertices.h"
#include "mesh/expect_sound.h"
#include "mesh/tissue_topology.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

const ShapeBounds kBounds = ShapeBounds::from_degrees(20, 150, 0.3);

void expect_sound(const TissueMesh& mesh) {
  testing::expect_sound(mesh.points_mm, mesh.tets);
  EXPECT_TRUE(std::is_sorted(mesh.tissues.begin(), mesh.tissues.end(), [](TissueId a, TissueId b) {
    return a != 0 && b == 0;
  })) << "the cushion is last";
  testing::expect_within(testing::worst_tissue_shape(mesh), 20, 150, 0.3);
}

/// Lines at which a surface is not manifold may shrink, but there are no new ones.
void expect_same_topology(const TissueMesh& mesh, const TissueMesh& before) {
  EXPECT_EQ(testing::topology_of(mesh), testing::topology_of(before));
  const auto had = testing::nonmanifold_tissues(before);
  for (const TissueId t : testing::nonmanifold_tissues(mesh)) EXPECT_TRUE(had.contains(t)) << "tissue " << t;
}

/// An image, its field and its lattice.
struct Case {
  explicit Case(const LabelImage& labels)
      : image(make_tissue_image(labels)), field(image), mesh(testing::lattice_of(image)), shifts(image) {}
  TissueImage image;
  SurfaceField field;
  TissueMesh mesh;
  VolumeShifts shifts;

  std::size_t coarsen(double surface_tolerance_mm) {
    MeshEditor editor(mesh);
    CoarsenLimits limits;
    limits.bounds = kBounds;
    limits.surface_tolerance_mm = surface_tolerance_mm;
    limits.max_turn_cos = surface_tolerance_mm > 1 ? -1 : 0.9;
    const std::size_t gone = anatomesh::coarsen(editor, field, limits, 10, testing::quiet_stage());
    mesh = editor.result();
    return gone;
  }
  ImproveReport improve(const ImproveOptions& options = {}) {
    return anatomesh::improve(mesh, field, kBounds, options, shifts, testing::quiet_stage());
  }
};

void expect_same_volumes(const TissueMesh& mesh, const TissueMesh& before) {
  const auto volumes = testing::volumes_of(mesh);
  for (const auto& [tissue, volume] : testing::volumes_of(before))
    EXPECT_NEAR(volumes.at(tissue), volume, 1e-9 * volume);
}

TEST(Coarsen, InsideLeavesInterfacesAsTheyAre) {
  std::size_t gone = 0;
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    Case c(labels);
    const TissueMesh before = c.mesh;
    gone += c.coarsen(0);
    expect_sound(c.mesh);
    EXPECT_EQ(testing::interfaces_of(c.mesh), testing::interfaces_of(before));
    expect_same_topology(c.mesh, before);
    expect_same_volumes(c.mesh, before);
  }
  EXPECT_GT(gone, 1000u);
}

// The tolerance is so large that only the link condition and the bounds are in the way.
TEST(Coarsen, OnInterfacesKeepsTheTopology) {
  std::size_t gone = 0;
  const auto check = [&](const LabelImage& labels) {
    Case c(labels);
    const TissueMesh before = c.mesh;
    gone += c.coarsen(1000);
    expect_sound(c.mesh);
    expect_same_topology(c.mesh, before);
  };
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    check(labels);
  }
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    check(testing::noise(seed));
    check(testing::random_blobs(seed, 14, 10));
  }
  EXPECT_GT(gone, 10000u);
}

TEST(Coarsen, StaysWithinTheTolerance) {
  Case c(testing::two_touching_cubes());
  c.improve();
  const auto before = testing::interfaces_of(c.mesh);
  c.coarsen(0.3);
  const auto after = testing::interfaces_of(c.mesh);
  EXPECT_LT(static_cast<double>(after.size()), 0.95 * static_cast<double>(before.size()));
  for (const auto& face : after) {
    if (before.contains(face)) continue;
    Vec3 middle;
    for (const auto& p : face.second) middle += (1.0 / 3) * Vec3{p[0], p[1], p[2]};
    std::array<double, 2> share;
    std::array<Vec3, 2> gradient;
    c.field.evaluate(middle, face.first, share, gradient);
    EXPECT_LE(std::abs(share[0] - share[1]), 0.3 * norm(gradient[0] - gradient[1]) + 1e-9);
  }
}

TEST(Coarsen, StopsAtTheTarget) {
  Case c(testing::sphere(12));
  MeshEditor editor(c.mesh);
  CoarsenLimits limits;
  limits.bounds = kBounds;
  limits.target_tets = editor.tissue_tets() * 9 / 10;
  coarsen(editor, c.field, limits, 10, testing::quiet_stage());
  EXPECT_LE(editor.tissue_tets(), limits.target_tets);
  EXPECT_GT(editor.tissue_tets(), limits.target_tets - 100);
}

double longest_edge(const TissueMesh& mesh, TissueId tissue) {
  double longest = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.tissues[t] != tissue) continue;
    for (const VertexId a : mesh.tets[t]) {
      for (const VertexId b : mesh.tets[t]) longest = std::max(longest, norm(mesh.points_mm[a] - mesh.points_mm[b]));
    }
  }
  return longest;
}

TEST(Coarsen, MakesNoLongEdges) {
  Case c(testing::nested_spheres());
  const double before = longest_edge(c.mesh, 1);
  MeshEditor editor(c.mesh);
  CoarsenLimits limits;
  limits.bounds = kBounds;
  const SizeField sizes{c.field.image(), {100, before, 100, 100}, {}};
  limits.sizes = &sizes;
  coarsen(editor, c.field, limits, 10, testing::quiet_stage());
  EXPECT_LE(longest_edge(editor.result(), 1), before);
  c.coarsen(0);
  EXPECT_GT(longest_edge(c.mesh, 1), before) << "without the limit";
}

TEST(ImproveShapes, LeavesInterfacesAsTheyAreAndTheWorstNoWorse) {
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    Case c(labels);
    const TissueMesh before = c.mesh;
    MeshEditor editor(c.mesh);
    improve_shapes(editor, kBounds, 1, testing::quiet_stage());
    const TissueMesh after = editor.result();
    expect_sound(after);
    EXPECT_EQ(testing::interfaces_of(after), testing::interfaces_of(before));
    expect_same_topology(after, before);
    expect_same_volumes(after, before);
    EXPECT_GE(testing::worst_tissue_shape(after).min_dihedral_deg,
              testing::worst_tissue_shape(before).min_dihedral_deg - 1e-9);
  }
}

TEST(ImproveShapes, MendsAMeshThatWasShaken) {
  Case c(testing::sphere(9));
  const ShapeBounds loose = ShapeBounds::from_degrees(2, 178, 0.01);
  std::uint32_t state = 1;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8u) / (1u << 24u) - 0.5;
  };
  const MeshTopology topology = make_topology(c.mesh);
  const AngleGuard guard(c.mesh, topology, loose);
  for (VertexId v = 0; v < c.mesh.points_mm.size(); ++v) {
    if (topology.on_interface(v) || topology.outside(v)) continue;
    const double x = random(), y = random(), z = random();
    guard.advance(v, c.mesh.points_mm[v] + 3.0 * Vec3{x, y, z}, 3);
  }
  const auto shaken = testing::worst_tissue_shape(c.mesh);
  ASSERT_LT(shaken.min_dihedral_deg, 8);
  MeshEditor mended(c.mesh);
  for (int n = 0; n < 4; ++n) improve_shapes(mended, kBounds, 0.05, testing::quiet_stage());
  EXPECT_GT(testing::worst_tissue_shape(mended.result()).min_dihedral_deg, 20);
}

/// Mean over the inner edges of the outer surface of 1 - cos of the angle between its faces there.
double roughness_of(const TissueMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, std::vector<Vec3>> normals;
  for (const auto& face : testing::all_faces(mesh.tets)) {
    if (face.tets.size() != 2 || (mesh.tissues[face.tets[0]] == 0) == (mesh.tissues[face.tets[1]] == 0)) continue;
    const auto [a, b, c] = face.vertices;
    const Vec3 n = cross(mesh.points_mm[b] - mesh.points_mm[a], mesh.points_mm[c] - mesh.points_mm[a]);
    for (const auto& edge : {std::pair{a, b}, std::pair{a, c}, std::pair{b, c}})
      normals[edge].push_back((1 / norm(n)) * n);
  }
  double sum = 0;
  for (const auto& [edge, n] : normals) sum += 1 - std::abs(dot(n[0], n[1]));
  return sum / static_cast<double>(normals.size());
}

TEST(FlipInterfaces, SmoothesAndKeepsTheTopologyAndTheBounds) {
  double before_all = 0, after_all = 0;
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    Case c(labels);
    c.improve();
    const TissueMesh before = c.mesh;
    MeshEditor editor(c.mesh);
    flip_interfaces(editor, c.field, kBounds, testing::quiet_stage());
    const TissueMesh after = editor.result();
    expect_sound(after);
    expect_same_topology(after, before);
    before_all += roughness_of(before);
    after_all += roughness_of(after);
  }
  EXPECT_LT(after_all, before_all);
}

TEST(SlideVertices, MakesTheWorstBetterAndStaysNear) {
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    Case c(labels);
    const TissueMesh before = c.mesh;
    MeshEditor editor(c.mesh);
    for (int n = 0; n < 3; ++n) slide_vertices(editor, c.field, kBounds, 0.2, testing::quiet_stage());
    const TissueMesh after = editor.result();
    expect_sound(after);
    expect_same_topology(after, before);
    EXPECT_EQ(after.tets, before.tets);
    EXPECT_GE(testing::worst_tissue_shape(after).min_dihedral_deg,
              testing::worst_tissue_shape(before).min_dihedral_deg - 1e-9);
  }
}

TEST(SplitLongEdges, GetsThemShorter) {
  Case c(testing::sphere(12));
  const double before = longest_edge(c.mesh, 1);
  MeshEditor editor(c.mesh);
  const SizeField sizes{c.field.image(), {100, 0.6 * before}, {}};
  EXPECT_GT(split_long_edges(editor, ShapeBounds::from_degrees(10, 170, 0.2), sizes, testing::quiet_stage()), 0u);
  const TissueMesh after = editor.result();
  EXPECT_LE(longest_edge(after, 1), 0.6 * before);
  expect_same_topology(after, c.mesh);
  expect_same_volumes(after, c.mesh);
}

TEST(GradedSizes, GrowAsFastAsAllowed) {
  const Case c(testing::sphere(12));
  const MeshEditor editor(c.mesh);
  const auto sizes = graded_sizes(editor, 0.5);
  for (TetId t = 0; t < editor.tet_count(); ++t) {
    for (const VertexId a : editor.tet(t)) {
      for (const VertexId b : editor.tet(t))
        EXPECT_LE(sizes[a], sizes[b] + 0.5 * norm(editor.point(a) - editor.point(b)) + 1e-9);
    }
  }
}

TEST(Improve, GuaranteesHoldOnEveryImage) {
  for (const auto& [name, labels] : testing::all_shapes()) {
    for (const double tolerance_mm : {0.0, 0.3}) {
      SCOPED_TRACE(name);
      Case c(labels);
      const TissueMesh before = c.mesh;
      ImproveOptions options;
      options.surface_tolerance_mm = tolerance_mm;
      const ImproveReport report = c.improve(options);
      expect_sound(c.mesh);
      expect_same_topology(c.mesh, before);
      EXPECT_LE(report.tets_after, report.tets_before + report.shape_changes);
    }
  }
}

TEST(Improve, MeetsATarget) {
  Case c(testing::random_blobs(7));
  ImproveOptions options;
  options.target_tets = c.improve().tets_after * 8 / 10;
  const TissueMesh before = c.mesh;
  EXPECT_LE(c.improve(options).tets_after, options.target_tets * 21 / 20) << "the last flips may add some";
  expect_sound(c.mesh);
  expect_same_topology(c.mesh, before);
}

TEST(Improve, DoesNotDependOnTheNumberOfThreads) {
  std::vector<TissueMesh> meshes;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    Case c(testing::random_blobs(4));
    ImproveOptions options;
    options.surface_tolerance_mm = 0.2;
    c.improve(options);
    meshes.push_back(c.mesh);
  }
  EXPECT_EQ(meshes[0].tets, meshes[1].tets);
  EXPECT_EQ(meshes[0].points_mm, meshes[1].points_mm);
}

TEST(Improve, StopsWhenAskedTo) {
  Case c(testing::sphere());
  std::stop_source source;
  const Progress progress{[&](std::string_view, double fraction) {
                            if (fraction > 0.3) source.request_stop();
                          },
                          source.get_token()};
  EXPECT_THROW(improve(c.mesh, c.field, kBounds, {}, c.shifts, Stage(progress, "improve", 0, 1)), Cancelled);
  expect_sound(c.mesh);
}

}  // namespace
}  // namespace anatomesh
