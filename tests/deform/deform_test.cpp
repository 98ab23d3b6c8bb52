#include "deform/deform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "deform/lattice_of.h"
#include "deform/split_bridges.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

void deform_quietly(TissueMesh& mesh, const TissueImage& image, const DeformOptions& options = {}) {
  const Deformer deformer(image, options, testing::quiet_stage());
  deformer.approach(mesh, testing::quiet_stage());
  deformer.finish(mesh, {}, testing::quiet_stage());
}

void expect_sound(const TissueMesh& mesh, const DeformOptions& options) {
  const auto worst = testing::worst_tissue_shape(mesh);
  constexpr double kRoundingDeg = 1e-9;  // the lattice has 30 degrees to the last digit
  EXPECT_GE(worst.min_dihedral_deg, options.min_dihedral_deg - kRoundingDeg);
  EXPECT_LE(worst.max_dihedral_deg, options.max_dihedral_deg + kRoundingDeg);
  EXPECT_GE(worst.mean_ratio, options.min_mean_ratio);
  EXPECT_GT(testing::smallest_volume(mesh.points_mm, mesh.tets), 0) << "of tissues and cushion";
}

/// Faces of the tissues' tetrahedra that no other tetrahedron has.
std::size_t bare_faces(const TissueMesh& mesh) {
  std::size_t bare = 0;
  for (const auto& face : testing::all_faces(mesh.tets))
    bare += face.tets.size() == 1 && mesh.tissues[face.tets[0]] != 0;
  return bare;
}

TEST(Deform, KeepsBoundsCushionAndTissuesOnEveryImage) {
  for (const auto& [name, labels] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    const TissueImage image = make_tissue_image(labels);
    TissueMesh mesh = testing::lattice_of(image);
    const std::set<TissueId> tissues(mesh.tissues.begin(), mesh.tissues.end());
    deform_quietly(mesh, image);
    expect_sound(mesh, {});
    EXPECT_EQ(testing::crowded_faces(mesh.points_mm, mesh.tets), 0u);
    EXPECT_EQ(bare_faces(mesh), 0u);
    EXPECT_EQ(std::set<TissueId>(mesh.tissues.begin(), mesh.tissues.end()), tissues);
  }
}

TEST(Deform, BoundsMayBeAnywhereInTheirRange) {
  const TissueImage image = make_tissue_image(testing::anisotropic(testing::four_label_point()));
  for (const auto& [low, high, mean_ratio] : {std::array{0.0, 180.0, 0.0}, std::array{5.0, 170.0, 0.1},
                                              std::array{25.0, 130.0, 0.4}, std::array{30.0, 117.0, 0.5}}) {
    SCOPED_TRACE(low);
    DeformOptions options;
    options.min_dihedral_deg = low;
    options.max_dihedral_deg = high;
    options.min_mean_ratio = mean_ratio;
    TissueMesh mesh = testing::lattice_of(image);
    deform_quietly(mesh, image, options);
    expect_sound(mesh, options);
  }
}

/// Mean distance of the interface vertices from a sphere (voxels of 1 mm).
double mean_distance(const TissueMesh& mesh, Vec3 centre, double radius) {
  const MeshTopology topology = make_topology(mesh);
  double sum = 0;
  int count = 0;
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    if (!topology.on_interface(v)) continue;
    sum += std::abs(norm(mesh.points_mm[v] - centre) - radius);
    ++count;
  }
  return sum / count;
}

TEST(Deform, BringsTheSurfaceOfABallToItsRadius) {
  for (const int radius : {6, 9, 13}) {
    const TissueImage image = make_tissue_image(testing::sphere(radius));
    const double true_radius = std::cbrt(3 * static_cast<double>(image.counts[1]) / (4 * std::numbers::pi));
    const Vec3 centre = (radius + 2.0) * Vec3{1, 1, 1};
    TissueMesh mesh = testing::lattice_of(image);
    const double before = mean_distance(mesh, centre, true_radius);
    deform_quietly(mesh, image);
    const double after = mean_distance(mesh, centre, true_radius);
    EXPECT_LT(after, 0.3) << "radius " << radius;
    EXPECT_LT(after, 0.5 * before) << "radius " << radius;
  }
}

/// Mean distance of the vertices between tissues 1 and 2, and no other, from the plane of this x.
double mean_distance_from_plane(const TissueMesh& mesh, double x) {
  const MeshTopology topology = make_topology(mesh);
  double sum = 0;
  int count = 0;
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    const auto tissues = topology.tissues_of_vertex[v];
    if (tissues.size() != 2 || tissues[0] != 1 || tissues[1] != 2) continue;
    sum += std::abs(mesh.points_mm[v].x - x);
    ++count;
  }
  return sum / count;
}

TEST(Deform, BringsAFlatInterfaceToItsPlane) {
  for (const LabelImage& labels :
       {testing::two_touching_cubes(), testing::anisotropic(testing::two_touching_cubes())}) {
    const TissueImage image = make_tissue_image(labels);
    TissueMesh mesh = testing::lattice_of(image);
    deform_quietly(mesh, image);
    const Vec3 s = image.spacing_mm;
    EXPECT_LT(mean_distance_from_plane(mesh, 12.5 * s.x), 0.25 * (s.x + s.y + s.z) / 3);
  }
}

TEST(Deform, DoesNotDependOnTheNumberOfThreads) {
  const TissueImage image = make_tissue_image(testing::random_blobs(2));
  const TissueMesh lattice = testing::lattice_of(image);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    TissueMesh mesh = lattice;
    deform_quietly(mesh, image);
    return mesh.points_mm;
  };
  EXPECT_EQ(with_threads(1), with_threads(3));
}

TEST(Deform, MoreIterationsDoNotBreakAnything) {
  const TissueImage image = make_tissue_image(testing::vessel_tree());
  for (const int iterations : {1, 40}) {
    DeformOptions options;
    options.iterations = iterations;
    TissueMesh mesh = testing::lattice_of(image);
    deform_quietly(mesh, image, options);
    expect_sound(mesh, options);
  }
}

TEST(Deform, StopsWhenAskedTo) {
  const TissueImage image = make_tissue_image(testing::sphere());
  TissueMesh mesh = testing::lattice_of(image);
  std::stop_source source;
  const Progress progress{[&](std::string_view, double fraction) {
                            if (fraction > 0.3) source.request_stop();
                          },
                          source.get_token()};
  const DeformOptions options;
  const Deformer deformer(image, options, testing::quiet_stage());
  EXPECT_THROW(deformer.approach(mesh, Stage(progress, "deform", 0, 1)), Cancelled);
  expect_sound(mesh, {});
}

}  // namespace
}  // namespace anatomesh
