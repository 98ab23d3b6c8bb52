// What is special about Gmsh's files; what Gmsh itself reads and writes is in tests/tools/gmsh_medit_test.py.
#include <string>

#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {
namespace {

class GmshFile : public NamedMeshFileTest {
 protected:
  GmshFile() : NamedMeshFileTest("mesh.msh") {}
};

using Tets = std::vector<std::array<VertexId, 4>>;

TEST_F(GmshFile, GroupsAndEntities) {
  TetMesh mesh = two_tets(5, 3);
  mesh.points_mm.push_back({9, 9, 9});  // of no tetrahedron
  mesh.names[5].name = "brain";
  EXPECT_EQ(written(mesh),
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
            "$PhysicalNames\n5\n2 6 \"label_3_skin\"\n2 7 \"label_3_to_brain\"\n2 8 \"brain_skin\"\n"
            "3 3 \"label_3\"\n3 5 \"brain\"\n$EndPhysicalNames\n"
            "$Entities\n0 0 3 2\n6 0 0 0 1 1 1 1 6 0\n7 0 0 0 1 1 1 1 7 0\n8 0 0 0 1 1 1 1 8 0\n"
            "3 0 0 0 1 1 1 1 3 2 6 7\n5 0 0 0 1 1 1 1 5 2 -7 8\n$EndEntities\n"
            "$Nodes\n3 6 1 6\n2 6 0 4\n2\n3\n4\n5\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n2 8 0 1\n1\n0 0 0\n"
            "3 3 0 1\n6\n9 9 9\n$EndNodes\n"
            "$Elements\n5 9 1 9\n2 6 2 3\n3 5 3 4\n4 2 5 4\n5 2 3 5\n2 7 2 1\n6 2 4 3\n2 8 2 3\n7 1 4 3\n8 1 2 4\n"
            "9 1 3 2\n3 3 4 1\n2 2 5 3 4\n3 5 4 1\n1 1 2 3 4\n$EndElements\n");
}

TEST_F(GmshFile, GroupsOfSurfacesClashWithNoLabel) {
  const std::string text = written(two_tets(2147483647, 2));
  for (const char* group : {"2 1 \"", "2 3 \"", "2 4 \""}) EXPECT_SAYS(text, group);
  EXPECT_EQ(text.find("\n2 2 \""), std::string::npos);
}

TEST_F(GmshFile, SurfacesAreNotCalledAsTissues) {
  TetMesh mesh = two_tets(1, 2);
  mesh.names[1].name.append("a");
  mesh.names[2].name.append("a_skin");
  const std::string text = written(mesh);
  for (const char* group : {"2 3 \"skin_of_1\"", "2 4 \"a_to_a_skin\"", "2 5 \"a_skin_skin\"", "3 2 \"a_skin\""}) {
    EXPECT_SAYS(text, group);
  }
}

TEST_F(GmshFile, TheLabelZeroIsNoGroup) {
  const auto file = in_folder("mesh.msh");
  EXPECT_SAYS(message_of<InvalidInput>(file, [&] { write_mesh(file, two_tets(0, 1)); }), "label 0");
  EXPECT_EQ(folder_listing(), "");
}

const std::string kStart41 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";

// Numbers with gaps and in any order, a point with parameters, elements that are left out, two groups, none.
TEST_F(GmshFile, Version41OfOthers) {
  const TetMesh mesh = read(
      kStart41 +
      "$Comments\nanything\n$EndComments\n$PhysicalNames\n3\n2 9 \"face\"\n3 9 \"brain\"\n3 4 \"label_4\"\n"
      "$EndPhysicalNames\n"
      "$Entities\n1 0 1 2\n1 0 0 0 0\n7 0 0 0 1 1 1 1 9 0\n1 0 0 0 1 1 1 2 -9 4 1 7\n6 0 0 0 1 1 1 0 0\n$EndEntities\n"
      "$Nodes\n2 5 10 50\n2 7 1 2\n50\n10\n5 5 5 .1 .2\n1 1 1 .3 .4\n3 1 0 3\n20\n30\n40\n2 2 2\n3 3 3\n4 4 "
      "4\n$EndNodes\n"
      "$Elements\n3 4 1 9\n2 7 2 1\n1 10 20 30\n3 6 4 1\n9 20 30 40 50\n3 1 4 2\n3 10 20 30 40\n2 50 20 30 40\n"
      "$EndElements\n");
  ASSERT_EQ(mesh.points_mm.size(), 5U);
  EXPECT_EQ(mesh.points_mm[4], (Vec3{5, 5, 5}));
  EXPECT_EQ(mesh.tets, (Tets{{4, 1, 2, 3}, {0, 1, 2, 3}, {1, 2, 3, 4}}));
  EXPECT_EQ(mesh.labels, (std::vector<Label>{9, 9, 6}));
  EXPECT_EQ(mesh.names, (LabelTable{{9, {"brain", {}}}}));
}

TEST_F(GmshFile, Version22OfOthers) {
  const TetMesh mesh = read(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
      "$Elements\n4\n1 15 2 0 1 1\n2 4 2 12 3 1 2 3 4\n3 4 2 0 3 1 2 4 3\n4 4 0 2 3 4 1\n$EndElements\n");
  EXPECT_EQ(mesh.tets, (Tets{{0, 1, 2, 3}, {0, 1, 3, 2}, {1, 2, 3, 0}}));
  EXPECT_EQ(mesh.labels, (std::vector<Label>{12, 3, 1}));
}

TEST_F(GmshFile, UnusableFilesAreRefused) {
  EXPECT_SAYS(refused<InvalidInput>("$MeshFormat\n4 0 8\n$EndMeshFormat\n"), "4.1 and 2.2");
  EXPECT_SAYS(refused<IoError>("$NOD\n0\n$ENDNOD\n"), "$MeshFormat");
  EXPECT_SAYS(refused<IoError>(kStart41), "no $Elements");
  EXPECT_SAYS(refused<IoError>(kStart41 + "$Nodes\n1 99999999 1 9\n3 1 0 99999999\n1\n"), "ends too early");
  EXPECT_SAYS(refused<IoError>(kStart41 + "$Elements\n1 1 1 1\n3 1 77 1\n"), "type 77");
  EXPECT_SAYS(refused<IoError>(kStart41 + "$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n"), "point 1");
  EXPECT_SAYS(refused<IoError>(kStart41 + "$Foo\nbar\n"), "$Foo");
  EXPECT_SAYS(refused<InvalidInput>(kStart41 + "$Elements\n1 1 1 1\n3 -5 4 1\n1 1 2 3 4\n$EndElements\n"), "group -5");
  EXPECT_SAYS(refused<InvalidInput>(kStart41 + "$Elements\n0 0 0 0\n$EndElements\n"), "no tetrahedra of 4 or 10 nodes");
}

}  // namespace
}  // namespace anatomesh::testing
