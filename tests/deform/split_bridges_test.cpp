#include "deform/split_bridges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "base/parallel.h"
#include "base/vec.h"
#include "deform/lattice_of.h"
#include "mesh/expect_sound.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

const ShapeBounds kNoBounds = ShapeBounds::from_degrees(0, 180, 0);

TissueMesh split_mesh(const LabelImage& image, const ShapeBounds& bounds = kNoBounds) {
  TissueMesh mesh = testing::lattice_of(make_tissue_image(image));
  split_bridges(mesh, bounds, testing::quiet_stage());
  return mesh;
}

std::map<TissueId, double> volumes(const TissueMesh& mesh) {
  std::map<TissueId, double> volume;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    volume[mesh.tissues[t]] += testing::shape_of(testing::corners_of(mesh.points_mm, mesh.tets[t])).volume;
  return volume;
}

/// Area between every two tissues.
std::map<std::pair<TissueId, TissueId>, double> areas(const TissueMesh& mesh) {
  std::map<std::pair<TissueId, TissueId>, double> area;
  for (const auto& face : testing::all_faces(mesh.tets)) {
    if (face.tets.size() < 2) continue;
    const auto [low, high] = std::minmax({mesh.tissues[face.tets[0]], mesh.tissues[face.tets[1]]});
    if (low != high) area[{low, high}] += testing::area_of(mesh.points_mm, std::array<testing::Face, 1>{face.vertices});
  }
  return area;
}

TEST(SplitBridges, VolumesAndSurfacesStay) {
  for (const auto& [name, image] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    const TissueMesh before = testing::lattice_of(make_tissue_image(image)), after = split_mesh(image);
    const auto new_volumes = volumes(after);
    const auto new_areas = areas(after);
    for (const auto& [tissue, volume] : volumes(before)) EXPECT_NEAR(new_volumes.at(tissue), volume, 1e-9 * volume);
    for (const auto& [pair, area] : areas(before)) EXPECT_NEAR(new_areas.at(pair), area, 1e-9 * area);
    EXPECT_EQ(new_areas.size(), areas(before).size());
  }
}

TEST(SplitBridges, MeshStaysSoundAndWellShaped) {
  for (const auto& [name, image] : testing::all_shapes()) {
    SCOPED_TRACE(name);
    const TissueMesh mesh = split_mesh(image);
    testing::expect_sound(mesh.points_mm, mesh.tets);
    testing::expect_within(testing::worst_shape(mesh.points_mm, mesh.tets), 25, 135, 0.4);
  }
}

TEST(SplitBridges, TighterBoundsAreKept) {
  const TissueMesh mesh = split_mesh(testing::vessel_tree(), ShapeBounds::from_degrees(29, 120, 0.5));
  const auto worst = testing::worst_shape(mesh.points_mm, mesh.tets);
  EXPECT_GE(worst.min_dihedral_deg, 29);
  EXPECT_LE(worst.max_dihedral_deg, 120);
  EXPECT_GE(worst.mean_ratio, 0.5);
}

/// Tissue tetrahedra with all four vertices on interfaces.
std::size_t stuck_tets(const TissueMesh& mesh) {
  const MeshTopology topology = make_topology(mesh);
  std::size_t stuck = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto on_interface = [&](VertexId v) { return topology.on_interface(v); };
    stuck += mesh.tissues[t] != 0 && std::all_of(mesh.tets[t].begin(), mesh.tets[t].end(), on_interface);
  }
  return stuck;
}

TEST(SplitBridges, FewTetsHaveAllTheirVerticesOnInterfaces) {
  for (const LabelImage& image : {testing::sphere(12), testing::nested_spheres(), testing::four_label_point()}) {
    const std::size_t before = stuck_tets(testing::lattice_of(make_tissue_image(image)));
    EXPECT_LT(stuck_tets(split_mesh(image)), before / 4) << "of " << before;
  }
}

TEST(SplitBridges, DoesNotDependOnTheNumberOfThreads) {
  std::vector<TissueMesh> meshes;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    meshes.push_back(split_mesh(testing::random_blobs(4)));
  }
  EXPECT_EQ(meshes[0].tets, meshes[1].tets);
  EXPECT_EQ(meshes[0].points_mm, meshes[1].points_mm);
}

}  // namespace
}  // namespace anatomesh
