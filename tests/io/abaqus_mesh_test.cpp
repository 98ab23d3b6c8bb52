#include "io/solver_fixture.h"

namespace anatomesh::testing {
namespace {

using AbaqusMesh = SolverFile;
using Labels = std::vector<Label>;

/// Four tetrahedra in a row, with numbers and sets of another tool.
std::string four_tets(const std::string& sets, const std::string& element_line = "*Element, type=C3D4") {
  return "*Heading\nanything\n** a comment\n" + element_line +
         "\n11, 1, 2, 3, 4\n12, 2, 3, 4, 5\n14, 4, 5, 6, 7\n13, 3, 4,\n5, 6\n" + sets +
         "*Node, nset=all\n7, 3, 3, 3\n1, 0., 0.\n2, 1\n3, 0, 1., 0\n4, 0, 0, 1e0\n5, 1, 1, 1\n6, +2, 1, 1, 0.5\n";
}

TEST_F(AbaqusMesh, HasSetsAndSurfacesByName) {
  const std::string text = written("mesh.inp", two_named_tissues());
  EXPECT_SAYS(text, "*ELEMENT, TYPE=C3D4, ELSET=white_matter\n1, 2, 5, 3, 4\n");
  EXPECT_SAYS(text, "*SURFACE, NAME=white_matter_skin, TYPE=ELEMENT\n1, S3\n1, S2\n1, S1\n");
  EXPECT_SAYS(text, "_to_white_matter, TYPE=ELEMENT\n2, S3\n");
  EXPECT_SAYS(text, "*NSET, NSET=white_matter_skin\n2, 3, 4, 5\n");
  EXPECT_SAYS(text, "*NSET, NSET=skin\n1, 2, 3, 4, 5\n");
}

TEST_F(AbaqusMesh, NumbersReadInTwentyCharactersAreNearTheirValue) {
  TetMesh mesh = two_named_tissues();
  mesh.points_mm[0] = {-1.2345678901234567e-7, 0.1234567890123456e-30, -98.76543210987654};
  const std::string text = written("mesh.inp", mesh);
  const std::size_t begin = text.find("*NODE\n1, ") + 9;
  EXPECT_NEAR(std::stod(text.substr(begin, 20)), mesh.points_mm[0].x, 1e-17);
  EXPECT_NEAR(std::stod(text.substr(text.find(", ", begin) + 2, 20)), 0, 1e-17);
  EXPECT_EQ(mesh_in("copy.inp", text).points_mm, mesh.points_mm);
}

TEST_F(AbaqusMesh, OfOtherTools) {
  const TetMesh mesh = mesh_in("mesh.inp", four_tets(""));
  EXPECT_EQ(mesh.labels, (Labels{1, 1, 1, 1}));
  ASSERT_EQ(mesh.points_mm.size(), 7U);
  EXPECT_EQ(mesh.points_mm[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh.points_mm[5], (Vec3{2, 1, 1}));
  EXPECT_EQ(mesh.tets[2], (std::array<VertexId, 4>{2, 3, 4, 5}));
  EXPECT_EQ(mesh.tets[3], (std::array<VertexId, 4>{3, 4, 5, 6}));
}

TEST_F(AbaqusMesh, ElementSetsAreTissues) {
  const auto labels = [&](const std::string& sets) { return mesh_in("mesh.inp", four_tets(sets)).labels; };
  EXPECT_EQ(labels("*Elset, elset=a\n11, 13\n*ELSET , ELSET = b\n12\n"), (Labels{1, 2, 1, 3}));
  EXPECT_EQ(labels("*Elset, elset=a, generate\n11, 13, 2\n"), (Labels{1, 2, 1, 2}));
  EXPECT_EQ(labels("*Elset, elset=a, generate\n12, 14\n"), (Labels{2, 1, 1, 1}));
  EXPECT_EQ(labels("*Elset, elset=a\n11\n*Elset, elset=b\n12,\n*Elset, elset=c\nA, 13\n"), (Labels{1, 2, 3, 4}));
  EXPECT_EQ(labels("*Elset, elset=a\n99\n*Elset, elset=b,\n internal\n12,\n"), (Labels{2, 1, 2, 2}));
}

TEST_F(AbaqusMesh, SmallerSetsAndSectionsDecide) {
  const std::string sets = "*Elset, elset=few\n11\n*Elset, elset=\"All of it\", generate\n11, 14\n";
  const TetMesh mesh = mesh_in("mesh.inp", four_tets(sets));
  EXPECT_EQ(mesh.labels, (Labels{1, 2, 2, 2}));
  EXPECT_EQ(mesh.names.at(2).name, "All of it");
  const std::string section = "*Solid Section, material=m, elset=\"ALL OF IT\"\n1.,\n";
  EXPECT_EQ(mesh_in("mesh.inp", four_tets(sets + section)).labels, (Labels{1, 1, 1, 1}));
  EXPECT_EQ(mesh_in("mesh.inp", four_tets("", "*ELEMENT, ELSET=x, TYPE=C3D4H")).names.at(1).name, "x");
}

TEST_F(AbaqusMesh, CommentsGiveTheLabels) {
  const std::string sets = "*Elset, elset=A\n11, 12, 13\n*Elset, elset=b\n13, 14\n** label 9 is a: Big\n";
  const TetMesh mesh = mesh_in("mesh.inp", four_tets(sets));
  EXPECT_EQ(mesh.labels, (Labels{9, 9, 9, 1}));
  EXPECT_EQ(mesh.names.at(9).name, "Big");
  EXPECT_EQ(mesh.names.size(), 1U);
}

TEST_F(AbaqusMesh, WhatCannotBeReadIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*INCLUDE, INPUT=nodes.inp\n"), "another file");
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*NODE, INPUT=nodes.inp\n"), "another file");
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*NODE, SYSTEM=C\n"), "coordinate system");
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*Instance, name=a, part=b\n1., 0., 0.\n"), "moves");
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*NODE\n1, 0, 0, 0\n"), "no tetrahedra of 4 or 10 nodes");
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", "*ELEMENT, TYPE=C3D20\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n"), "C3D20");
}

TEST_F(AbaqusMesh, DamageIsNamed) {
  EXPECT_SAYS(refused<IoError>("mesh.inp", "*NODE\n1, 0, x, 0\n"), "line 2: 'x'");
  EXPECT_SAYS(refused<IoError>("mesh.inp", "*ELEMENT, TYPE=C3D4\n3, 1, 2, 3\n*NODE\n"), "lacks corners");
  EXPECT_SAYS(refused<IoError>("mesh.inp", four_tets("*ELSET, ELSET=a\nmissing\n")), "'missing' is not there yet");
  EXPECT_SAYS(refused<IoError>("mesh.inp", four_tets("*NODE\n7, 0, 0, 0\n")), "point 7 is there twice");
  EXPECT_SAYS(refused<IoError>("mesh.inp", "*ELEMENT, TYPE=C3D4\n3, 1, 2, 3, 4\n*NODE\n1, 0, 0, 0\n"), "to point 2");
  const std::string endless = "*ELSET, ELSET=a, GENERATE\n1, 1000000000000000000\n";
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", four_tets(endless)), "more elements than it can hold");
  std::string doubling = "*ELSET, ELSET=a0\n11\n";
  for (int n = 1; n < 100; ++n) {
    const std::string before = std::to_string(n - 1);
    doubling.append("*ELSET, ELSET=a").append(std::to_string(n)).append("\na").append(before);
    doubling.append(", a").append(before).append("\n");
  }
  EXPECT_SAYS(refused<InvalidInput>("mesh.inp", four_tets(doubling)), "more elements than it can hold");
}

}  // namespace
}  // namespace anatomesh::testing
