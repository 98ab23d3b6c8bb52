#include "deform/settle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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
  const DeformOptions options = strict_bounds();
  const Deformer deformer(image, options, testing::quiet_stage());
  deformer.approach(mesh, testing::quiet_stage());
  deformer.finish(mesh, {}, testing::quiet_stage());
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

LabelImage two_halves() {
  return testing::make_image({32, 32, 32}, [](int i, int j, int k) {
    const Vec3 p = {i - 15.5, j - 15.5, k - 15.5};
    return static_cast<Label>(norm(p) > 15 ? 0 : dot(p, {0.8, 0.5, 0.3}) < 1 ? 1 : 2);
  });
}

double degrees_between(Vec3 a, Vec3 b) {
  return std::acos(std::clamp(dot(a, b) / (norm(a) * norm(b)), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Mean angle between the normals of interface faces that share an edge.
double mean_surface_angle_deg(const TissueMesh& mesh, const TissueImage& image) {
  const std::vector<InterfaceFace> faces = find_interface_faces(mesh, make_topology(mesh), image).faces;
  std::map<std::pair<VertexId, VertexId>, Vec3> normal_at;  // of the face that has the edge in this direction
  for (const InterfaceFace& face : faces) {
    const auto& v = face.vertices;
    const Vec3 a = mesh.points_mm[v[0]];
    const Vec3 normal = cross(mesh.points_mm[v[1]] - a, mesh.points_mm[v[2]] - a);
    for (std::size_t n = 0; n < 3; ++n) normal_at[{v[n], v[(n + 1) % 3]}] = normal;
  }
  double sum = 0;
  int count = 0;
  for (const auto& [edge, normal] : normal_at) {
    const auto other = normal_at.find({edge.second, edge.first});
    if (other == normal_at.end()) continue;
    sum += degrees_between(normal, other->second);
    ++count;
  }
  return sum / count;
}

TEST(Settle, ABallIsSmooth) {
  const TissueImage image = make_tissue_image(testing::sphere(12));
  const TissueMesh mesh = deformed(image);
  EXPECT_LT(mean_surface_angle_deg(mesh, image), 8);
}

TEST(Settle, AJunctionLineIsSmooth) {
  double turning = 0, off = 0;
  int count = 0;
  for (const double slope : {-0.3, -0.15, 0.1, 0.2, 0.35}) {
    const TissueImage image = make_tissue_image(testing::make_image({30, 30, 30}, [slope](int i, int j, int k) {
      const double x = i - 14.7, y = j - 14.2 - slope * (k - 15);
      if (std::hypot(x, y, k - 14.5) > 13) return Label{0};
      return static_cast<Label>(y < -0.5 * std::abs(x) ? 1 : x < 0 ? 2 : 3);
    }));
    const TissueMesh mesh = deformed(image);
    const MeshTopology topology = make_topology(mesh);
    for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
      const auto tissues = topology.tissues_of_vertex[v];
      const auto on_line = topology.interface_neighbours[v];
      if (tissues.size() != 3 || tissues[0] == 0 || on_line.size() != 2) continue;
      const Vec3 p = mesh.points_mm[v];
      turning += degrees_between(p - mesh.points_mm[on_line[0]], mesh.points_mm[on_line[1]] - p);
      off += std::hypot(p.x - 14.7, p.y - 14.2 - slope * (p.z - 15));
      ++count;
    }
  }
  EXPECT_GT(count, 60);
  EXPECT_LT(turning / count, 24);
  EXPECT_LT(off / count, 0.4);
}

TEST(Settle, TissuesOfMoreThan5000VoxelsKeepTheirVolume) {
  const std::vector<testing::NamedImage> images = {
      {"ball", testing::sphere(12)},
      {"ellipsoid", ellipsoid({14.5, 12, 8})},
      {"ring", ring(9.5, 5.5)},
      {"two halves", two_halves()},
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

/// Whether all interface faces at v lie in one border plane of the image.
bool in_border_plane(const InterfaceFaces& faces, VertexId v) {
  const auto at_v = faces.of_vertex[v];
  const auto& first = faces.faces[at_v[0]].border;
  return std::ranges::all_of(at_v, [&](std::uint32_t f) {
    const auto& border = faces.faces[f].border;
    return first && border && border->axis == first->axis && border->position_mm == first->position_mm;
  });
}

TEST(Settle, FacesAtTheBorderOfTheImageAreFlatAndOnIt) {
  std::size_t in_plane = 0, in_plane_exact = 0, corners = 0, exact = 0;
  for (const double radius : {3.0, 3.5, 4.0, 4.5, 5.0}) {
    // A tissue that fills the lower half of the image, with a ball of background in it.
    const TissueImage image = make_tissue_image(testing::make_image({24, 24, 20}, [radius](int i, int j, int k) {
      return static_cast<Label>(k < 10 && std::hypot(i - 11.5, j - 11.5, k - 4.0) > radius);
    }));
    const TissueMesh mesh = deformed(image);
    const InterfaceFaces faces = find_interface_faces(mesh, make_topology(mesh), image);
    for (const InterfaceFace& face : faces.faces) {
      if (!face.border) continue;
      for (const VertexId v : face.vertices) {
        const double off = std::abs(mesh.points_mm[v][face.border->axis] - face.border->position_mm);
        ++corners;
        exact += off == 0;
        in_plane += in_border_plane(faces, v);
        in_plane_exact += in_border_plane(faces, v) && off == 0;
      }
    }
  }
  EXPECT_GT(corners, 5000u);
  // The edges of the image's box are as sharp as the bounds allow.
  EXPECT_GT(exact, corners * 88 / 100);
  EXPECT_GT(in_plane_exact, in_plane * 95 / 100);
}

double distance_from_nearest_border(const TissueImage& image, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a)
    least = std::min({least, std::abs(p[a] - image.low_border_mm(a)), std::abs(p[a] - image.high_border_mm(a))});
  return least;
}

TEST(Settle, AnImageWithoutBackgroundKeepsItsBox) {
  const TissueImage image = make_tissue_image(testing::make_image({30, 26, 22}, [](int i, int j, int k) {
    return static_cast<Label>(1 + (std::hypot(i - 15, j - 12, k - 10) < 7));
  }));
  const TissueMesh mesh = deformed(image);
  double area = 0, flat = 0;
  for (const InterfaceFace& face : find_interface_faces(mesh, make_topology(mesh), image).faces) {
    if (face.low != 0) continue;
    const auto& [a, b, c] = face.vertices;
    const double size = norm(cross(mesh.points_mm[b] - mesh.points_mm[a], mesh.points_mm[c] - mesh.points_mm[a])) / 2;
    area += size;
    const Vec3 centre = (1.0 / 3) * (mesh.points_mm[a] + mesh.points_mm[b] + mesh.points_mm[c]);
    if (distance_from_nearest_border(image, centre) < 0.1) flat += size;
  }
  EXPECT_NEAR(area, 2 * (30 * 26 + 30 * 22 + 26 * 22), 80);
  EXPECT_GT(flat, 0.93 * area);
}

}  // namespace
}  // namespace anatomesh
