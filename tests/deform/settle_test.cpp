#include "deform/settle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/vec.h"
#include "deform/deform.h"
#include "deform/interface_faces.h"
#include "deform/lattice_of.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

DeformOptions strict_bounds() {
  DeformOptions options;
  options.min_dihedral_deg = 20;
  options.max_dihedral_deg = 150;
  return options;
}

TissueMesh deformed(const TissueImage& image) {
  TissueMesh mesh = testing::lattice_of(image);
  deform(mesh, image, strict_bounds(), testing::quiet_stage());
  return mesh;
}

/// Volume of each tissue in the mesh over that of its voxels, less 1.
std::vector<double> volume_errors(const TissueMesh& mesh, const TissueImage& image) {
  std::vector<double> volume(image.labels.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& v = mesh.tets[t];
    volume[mesh.tissues[t]] +=
        six_volumes(mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]], mesh.points_mm[v[3]]) / 6;
  }
  const Vec3 s = image.spacing_mm;
  for (std::size_t t = 0; t < volume.size(); ++t)
    volume[t] = volume[t] / (static_cast<double>(image.counts[t]) * s.x * s.y * s.z) - 1;
  return volume;
}

LabelImage ellipsoid(Vec3 semi_axes) {
  return testing::make_image({32, 32, 32}, [&](int i, int j, int k) {
    const Vec3 p = {(i - 15.5) / semi_axes.x, (j - 15.5) / semi_axes.y, (k - 15.5) / semi_axes.z};
    return static_cast<Label>(norm(p) < 1 ? 1 : 0);
  });
}

LabelImage ring(double radius, double thickness) {
  return testing::make_image({32, 32, 32}, [&](int i, int j, int k) {
    const double out = std::hypot(i - 15.5, j - 15.5) - radius;
    return static_cast<Label>(std::hypot(out, k - 15.5) < thickness ? 1 : 0);
  });
}

TEST(Settle, TissuesOfMoreThan5000VoxelsKeepTheirVolume) {
  const std::vector<testing::NamedImage> images = {
      {"ball", testing::sphere(12)},
      {"ellipsoid", ellipsoid({14.5, 12, 8})},
      {"ring", ring(9.5, 5)},
      {"blobs", testing::random_blobs(3, 32, 3)},
  };
  for (const auto& [name, labels] : images) {
    SCOPED_TRACE(name);
    const TissueImage image = make_tissue_image(labels);
    const std::vector<double> errors = volume_errors(deformed(image), image);
    for (std::size_t t = 1; t < errors.size(); ++t) {
      if (image.counts[t] <= 5000) continue;
      EXPECT_LT(std::abs(errors[t]), 0.01) << "tissue " << t;
    }
  }
}

TEST(Settle, ALineOneVoxelWideKeepsItsVolume) {
  const TissueImage image = make_tissue_image(testing::make_image(
      {24, 24, 24}, [](int i, int j, int k) { return static_cast<Label>(i > 2 && i < 21 && j == 12 && k == 12); }));
  EXPECT_GT(volume_errors(deformed(image), image)[1], -0.3);
}

TEST(Settle, FacesAtTheBorderOfTheImageAreFlatAndOnIt) {
  // A tissue that fills the lower half of the image, with a ball of background in it.
  const TissueImage image = make_tissue_image(testing::make_image({20, 20, 20}, [](int i, int j, int k) {
    return static_cast<Label>(k < 10 && std::hypot(i - 9.5, j - 9.5, k - 4.0) > 4);
  }));
  const TissueMesh mesh = deformed(image);
  const MeshTopology topology = make_topology(mesh);
  std::size_t faces = 0, exact = 0;
  for (const InterfaceFace& face : find_interface_faces(mesh, topology, image).faces) {
    if (!face.border) continue;
    for (const VertexId v : face.vertices) {
      ++faces;
      exact += mesh.points_mm[v][face.border->axis] == face.border->position_mm;
    }
  }
  EXPECT_GT(faces, 100u);
  EXPECT_EQ(exact, faces);
}

}  // namespace
}  // namespace anatomesh
