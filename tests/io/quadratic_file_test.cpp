// Quadratic tetrahedra in every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "anatomesh/quadratic.h"
#include "io/mesh_file_fixture.h"
#include "io/mesh_format.h"

namespace anatomesh::testing {
namespace {

/// Two curved ones.
TetMesh curved() {
  TetMesh mesh = quadratic_mesh(two_uneven_tets(3, 17));
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) mesh.points_mm[n].x += 0.01 / static_cast<double>(n + 3);
  return mesh;
}

using QuadraticFile = MeshFileTest;

TEST_F(QuadraticFile, RoundTripsExactly) {
  const TetMesh mesh = curved();
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    SCOPED_TRACE(format.extension);
    const auto file = in_folder(std::string("mesh").append(format.extension));
    write_mesh(file, mesh);
    expect_same(read_mesh(file), mesh);
  }
}

TEST_F(QuadraticFile, DamagedFilesNeverCrash) {
  std::mt19937 random(7);
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr || format.extension == ".xdmf") continue;  // its numbers lie in another file
    const std::string name = std::string("mesh").append(format.extension);
    const std::string bytes = written(name, curved());
    for (int trial = 0; trial < 100; ++trial)
      message_of_damaged(put(name, with_changed_bytes(bytes, 1 + trial % 3, random)));
  }
}

TEST_F(QuadraticFile, FacesOfSurfacesBecomeFour) {
  write_mesh(in_folder("mesh.obj"), curved());
  std::ifstream file(in_folder("mesh.obj"));
  std::size_t faces = 0;
  for (std::string line; std::getline(file, line);) faces += line.starts_with("f ");
  EXPECT_EQ(faces, 4U * 7);  // the skins of two tetrahedra, and the face between them once
}

TEST_F(QuadraticFile, NodeSetsHoldEdgeNodes) {
  const std::string text = written("mesh.inp", curved());
  EXPECT_NE(text.find("TYPE=C3D10, ELSET=label_3"), std::string::npos);
  const std::size_t set = text.find("*NSET, NSET=label_3_to_label_17");
  ASSERT_NE(set, std::string::npos);
  const std::string members = text.substr(text.find('\n', set) + 1, text.find("\n*", set) - text.find('\n', set) - 1);
  EXPECT_EQ(std::ranges::count(members, ','), 5);
}

TEST_F(QuadraticFile, TwoKindsInOneMeshAreRefused) {
  const std::string mixed =
      "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n"
      "10,0,.5,.5\n11,0,0,-1\n*ELEMENT, TYPE=C3D10\n1,1,2,3,4,5,6,7,8,9,10\n"
      "*ELEMENT, TYPE=C3D4\n2,1,3,2,11\n";
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", mixed), "1 linear and 1 quadratic tetrahedra");
}

TEST_F(QuadraticFile, TetrahedraThatLackNodesAreRefused) {
  EXPECT_SAYS(refused<IoError>("mesh.inp", "*ELEMENT, TYPE=C3D10\n1,1,2,3,4,5,6,7,8,9\n*NODE\n"), "lacks corners");
}

}  // namespace
}  // namespace anatomesh::testing
