#include "deform/volume_shifts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "deform/lattice_of.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

struct Sums {
  double volume_mm3 = 0, area_mm2 = 0;
};

Sums enclosed(const TissueMesh& mesh, const InterfaceFaces& interfaces) {
  Sums sums;
  for (const InterfaceFace& face : interfaces.faces) {
    const Vec3 a = mesh.points_mm[face.vertices[0]], b = mesh.points_mm[face.vertices[1]],
               c = mesh.points_mm[face.vertices[2]];
    sums.volume_mm3 -= dot(a, cross(b, c)) / 6;  // the normals point into the tissue
    sums.area_mm2 += norm(cross(b - a, c - a)) / 2;
  }
  return sums;
}

TEST(VolumeShifts, OfOneTissueAreWhatItLacksOverItsArea) {
  const TissueImage image = make_tissue_image(testing::sphere(9));
  TissueMesh mesh = testing::lattice_of(image);
  const InterfaceFaces interfaces = find_interface_faces(mesh, make_topology(mesh), image);
  for (const double scale : {0.995, 1.005, 0.8, 1.3}) {
    TissueMesh scaled = mesh;
    const Sums before = enclosed(mesh, interfaces);
    const double to_image = std::cbrt(image.volume_mm3(1) / before.volume_mm3);
    Vec3 centre;
    for (const Vec3& p : mesh.points_mm) centre += (1.0 / static_cast<double>(mesh.points_mm.size())) * p;
    for (Vec3& p : scaled.points_mm) p = centre + scale * to_image * (p - centre);
    VolumeShifts shifts(image);
    EXPECT_EQ(shifts.between(0, 1), 0);
    shifts.update(scaled, interfaces);
    const Sums now = enclosed(scaled, interfaces);
    const double wanted =
        (now.volume_mm3 - image.volume_mm3(1)) / now.area_mm2;  // into the tissue where it is too large
    EXPECT_NEAR(shifts.between(0, 1), std::clamp(0.9 * wanted, -0.15, 0.15), 1e-3);
  }
}

TEST(VolumeShifts, StayFiniteWithoutABackground) {
  const TissueImage image = make_tissue_image(
      testing::make_image({16, 16, 16}, [](int i, int, int) { return static_cast<Label>(i < 6 ? 1 : 2); }));
  const TissueMesh mesh = testing::lattice_of(image);
  const InterfaceFaces interfaces = find_interface_faces(mesh, make_topology(mesh), image);
  VolumeShifts shifts(image);
  for (int n = 0; n < 20; ++n) shifts.update(mesh, interfaces);
  EXPECT_LE(std::abs(shifts.between(1, 2)), 0.15);
  EXPECT_LE(std::abs(shifts.between(0, 1)), 0.15);
}

}  // namespace
}  // namespace anatomesh
