#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"
#include "io/surface.h"
#include "io/surface_bytes.h"

namespace anatomesh::testing {
namespace {

class SurfaceFiles : public IoTest {};

/// A cube of six tetrahedra around a diagonal, of three labels, with a vertex that none uses.
TetMesh cube() {
  TetMesh mesh;
  for (const double z : {0, 1}) {
    for (const double y : {0, 1}) {
      for (const double x : {0, 1}) mesh.points_mm.push_back({x, y, z});
    }
  }
  mesh.points_mm.insert(mesh.points_mm.begin(), {9, 9, 9});
  for (const auto& [a, b] : {std::pair{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}}) {
    mesh.tets.push_back({1, static_cast<VertexId>(a + 1), static_cast<VertexId>(b + 1), 8});
  }
  mesh.labels = {3, 3, 8, 8, 5, 5};
  mesh.names[3] = {"Left lung", Colour{255, 0, 0}};
  mesh.names[8] = {"left_lung", Colour{0, 255, 0}};
  return mesh;
}

using Edge = std::pair<VertexId, VertexId>;

/// Whether every edge is passed as often in one direction as in the other.
bool is_closed(const Surface& surface) {
  std::map<Edge, int> passed;
  for (const SurfacePart& part : surface.parts) {
    for (const auto& t : part.triangles) {
      for (std::size_t n = 0; n < 3; ++n) {
        const auto [a, b] = std::pair(t[n], t[(n + 1) % 3]);
        passed[std::minmax(a, b)] += a < b ? 1 : -1;
      }
    }
  }
  return std::ranges::all_of(passed, [](const auto& entry) { return entry.second == 0; });
}

/// By the divergence theorem.
double volume_mm3(const Surface& surface) {
  double six_volumes = 0;
  for (const SurfacePart& part : surface.parts) {
    for (const auto& [a, b, c] : part.triangles) {
      const Vec3 p = surface.points_mm[a], q = surface.points_mm[b], r = surface.points_mm[c];
      six_volumes += p.x * (q.y * r.z - q.z * r.y) + p.y * (q.z * r.x - q.x * r.z) + p.z * (q.x * r.y - q.y * r.x);
    }
  }
  return six_volumes / 6;
}

TEST_F(SurfaceFiles, InterfacesOnce) {
  const Surface surface = interface_surface(cube());
  EXPECT_EQ(triangle_count(surface), 12U + 3U);
  EXPECT_EQ(surface.points_mm.size(), 8U);  // the unused one is gone
  std::set<std::string> names;
  for (const SurfacePart& part : surface.parts) names.insert(part.name);
  EXPECT_EQ(names, (std::set<std::string>{"Left_lung_3_skin", "Left_lung_3_to_label_5", "Left_lung_3_to_left_lung_8",
                                          "label_5_skin", "label_5_to_left_lung_8", "left_lung_8_skin"}));
}

TEST_F(SurfaceFiles, TissuesAreClosedAndSeenFromOutside) {
  const std::map<Label, Surface> surfaces = tissue_surfaces(cube());
  ASSERT_EQ(surfaces.size(), 3U);
  for (const auto& [label, surface] : surfaces) {
    EXPECT_TRUE(is_closed(surface)) << label;
    EXPECT_NEAR(volume_mm3(surface), 1.0 / 3, 1e-15) << label;
    for (const SurfacePart& part : surface.parts) EXPECT_EQ(part.inside, label);
  }
}

TEST_F(SurfaceFiles, StlHoldsTheTriangles) {
  const Surface surface = interface_surface(cube());
  const std::string bytes = stl_bytes(surface);
  ASSERT_EQ(bytes.size(), 84 + 50 * triangle_count(surface));
  EXPECT_NE(bytes.substr(0, 5), "solid");
  float values[12];
  std::memcpy(values, bytes.data() + 84, sizeof(values));
  const auto& first = surface.parts[0].triangles[0];
  for (std::size_t n = 0; n < 9; ++n) EXPECT_EQ(values[3 + n], surface.points_mm[first[n / 3]][n % 3]);
  EXPECT_FLOAT_EQ(values[0] * values[0] + values[1] * values[1] + values[2] * values[2], 1);
}

TEST_F(SurfaceFiles, TextsSayWhatTheyHold) {
  TetMesh mesh = cube();
  EXPECT_EQ(ply_bytes(interface_surface(mesh)).find("red"), std::string::npos);  // label 5 has no colour
  mesh.names[5].colour = Colour{};
  EXPECT_SAYS(ply_bytes(interface_surface(mesh)), "property uchar red");
  EXPECT_SAYS(obj_bytes(interface_surface(mesh)), "\ng Left_lung_3_to_label_5\nf ");
  EXPECT_SAYS(vtp_bytes(interface_surface(mesh)), "label_outside");
}

TEST_F(SurfaceFiles, OneFileATissue) {
  for (const std::string extension : {".stl", ".ply", ".obj", ".vtp"}) {
    const auto files = write_tissue_surfaces(in_folder("chest" + extension), cube());
    ASSERT_EQ(files.size(), 3U);
    EXPECT_EQ(files[0], in_folder("chest_Left_lung_3" + extension));
    EXPECT_EQ(files[1], in_folder("chest_label_5" + extension));
    EXPECT_EQ(files[2], in_folder("chest_left_lung_8" + extension));
    for (const auto& file : files) {
      EXPECT_FALSE(bytes_of(file).empty());
      std::filesystem::remove(file);
    }
    EXPECT_EQ(folder_listing(), "");
  }
}

TEST_F(SurfaceFiles, AllTissuesOrNone) {
  std::filesystem::create_directory(in_folder("chest_left_lung_8.stl"));
  put("chest_label_5.stl", "earlier");
  message_of<IoError>("chest_left_lung_8.stl", [&] { write_tissue_surfaces(in_folder("chest.stl"), cube()); });
  EXPECT_EQ(folder_listing(), "chest_label_5.stl chest_left_lung_8.stl");
  EXPECT_EQ(bytes_of(in_folder("chest_label_5.stl")), "earlier");
}

TEST_F(SurfaceFiles, OnlySurfacesForTissues) {
  for (const char* name : {"chest", "chest.vtu"}) {
    const auto file = in_folder(name);
    EXPECT_SAYS(message_of<InvalidInput>(file, [&] { check_tissue_surfaces_writable(file); }), ".stl, .ply");
    EXPECT_SAYS(message_of<InvalidInput>(file, [&] { write_tissue_surfaces(file, cube()); }), ".stl, .ply");
  }
  const auto stl = in_folder("chest.stl");
  write_mesh(stl, cube());
  EXPECT_SAYS(message_of<InvalidInput>(stl, [&] { read_mesh(stl); }), ".vtu");
}

}  // namespace
}  // namespace anatomesh::testing
