// What is special about MEDIT's files; what Gmsh and meshio read and write is in tests/tools/gmsh_medit_test.py.
#include <string>

#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {
namespace {

class MeditFile : public NamedMeshFileTest {
 protected:
  MeditFile() : NamedMeshFileTest("mesh.mesh") {}
};

TEST_F(MeditFile, ReferencesAndComments) {
  TetMesh mesh = two_tets(5, 3);
  mesh.names[5].name = "white matter";
  EXPECT_EQ(written(mesh),
            "MeshVersionFormatted 2\nDimension 3\n# label 5 white matter\n# surface 6 label_3_skin\n"
            "# surface 7 label_3_to_white matter\n# surface 8 white matter_skin\n"
            "\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
            "\nTriangles\n7\n5 3 4 6\n2 5 4 6\n2 3 5 6\n2 4 3 7\n1 4 3 8\n1 2 4 8\n1 3 2 8\n"
            "\nTetrahedra\n2\n1 2 3 4 5\n2 5 3 4 3\n\nEnd\n");
}

TEST_F(MeditFile, OfOthers) {
  const TetMesh mesh = read(
      "MeshVersionFormatted\n1\n\nDimension\n3\n#label 7 brain # stem\n#label x\n#\nTetrahedra 1\n1 2 3 4 7\n"
      "Corners\n2\n1\n2\nSomething 0.5 -1e3\nRequiredVertices 1 3\n# a comment\nVertices\n4\n0 0 0 1\n1 0 0 -2\n0 1 0 "
      "3\n"
      "0 0 1 4\nEnd\nof it");
  EXPECT_EQ(mesh.tets, (std::vector<std::array<VertexId, 4>>{{0, 1, 2, 3}}));
  EXPECT_EQ(mesh.points_mm[3], (Vec3{0, 0, 1}));
  EXPECT_EQ(mesh.labels, (std::vector<Label>{7}));
  EXPECT_EQ(mesh.names, (LabelTable{{7, {"brain # stem", {}}}}));
}

TEST_F(MeditFile, UnusableFilesAreRefused) {
  const std::string start = "MeshVersionFormatted 2\nDimension 3\n";
  EXPECT_SAYS(refused<IoError>("MFEM mesh v1.0\n"), "MeshVersionFormatted");
  EXPECT_SAYS(refused<InvalidInput>("MeshVersionFormatted 2\nDimension 2\nEnd\n"), "dimension 2");
  EXPECT_SAYS(refused<IoError>(start + "Vertices 999999\n0 0 0 0\n"), "ends too early");
  EXPECT_SAYS(refused<IoError>(start + "Vertices 1\n0 0 0 0\n"), "no End");
  EXPECT_SAYS(refused<IoError>(start + "Vertices 1\n0 0 0 0\nTetrahedra 1\n1 1 1 2 0\nEnd\n"), "point 2");
  EXPECT_SAYS(refused<InvalidInput>(start + "Tetrahedra 1\n1 1 1 1 -3\nEnd\n"), "reference -3");
  EXPECT_SAYS(refused<InvalidInput>(start + "Vertices 1\n0 0 0 0\nEnd\n"), "no tetrahedra of 4 or 10 nodes");
  EXPECT_SAYS(refused<IoError>(start + "7 8 9\nEnd\n"), "where a section should begin");
}

}  // namespace
}  // namespace anatomesh::testing
