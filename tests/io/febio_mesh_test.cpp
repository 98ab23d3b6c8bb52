#include "io/solver_fixture.h"

namespace anatomesh::testing {
namespace {

using FebioMesh = SolverFile;

const char* const kNodes =
    "<Nodes><node id='3'> 0.0, 0.0,\n 0.0</node><node id='4'>1,0,0</node></Nodes>"
    "<Nodes name='more'><node id='5'>0,1,0</node><node id='6'>0,0,+1</node></Nodes>";

std::string model(const std::string& mesh, const std::string& section = "Mesh", const std::string& material = "") {
  return "<?xml version=\"1.0\"?><febio_spec version=\"3.0\"><Material>" + material + "</Material><" + section + ">" +
         mesh + "</" + section + "></febio_spec>";
}

std::string part(const std::string& name, const std::string& elements, const std::string& type = "tet4") {
  return "<Elements type='" + type + "' name='" + name + "'>" + elements + "</Elements>";
}

TEST_F(FebioMesh, HasPartsMaterialsAndSurfaces) {
  const std::string text = written("mesh.feb", two_named_tissues());
  EXPECT_SAYS(text, "<febio_spec version=\"4.0\">");
  EXPECT_SAYS(text, "<material id=\"2\" name=\"white_matter\" type=\"neo-Hookean\">");
  EXPECT_SAYS(text, "<Elements type=\"tet4\" name=\"white_matter\">\n      <elem id=\"1\">2,5,3,4</elem>\n");
  EXPECT_SAYS(text, "<Surface name=\"white_matter_skin\">\n      <tri3 id=\"1\">5,3,4</tri3>\n");
  EXPECT_SAYS(text, "<NodeSet name=\"skin\">1,2,3,4,5</NodeSet>");
  EXPECT_SAYS(text, "<SolidDomain name=\"white_matter\" mat=\"white_matter\"/>");
}

TEST_F(FebioMesh, OfOtherTools) {
  const std::string parts = part("Left &amp; right", "<elem id='9'>3,4,5,6</elem>") +
                            part("shell", "<elem id='1'>3,4,5</elem>", "tri3") +
                            part("Other", "<elem id='8'> 4, 3,5, 6</elem>");
  for (const char* section : {"Mesh", "Geometry"}) {
    const TetMesh mesh = mesh_in("mesh.feb", model(kNodes + parts, section));
    EXPECT_EQ(mesh.points_mm, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.tets, (std::vector<std::array<VertexId, 4>>{{1, 0, 2, 3}, {0, 1, 2, 3}}));
    EXPECT_EQ(mesh.labels, (std::vector<Label>{2, 1}));
    EXPECT_EQ(mesh.names.at(1).name, "Left & right");
  }
}

TEST_F(FebioMesh, WhatCannotBeReadIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>("mesh.feb", "<febio_spec><Mesh from='other.feb'/></febio_spec>"), "other.feb");
  EXPECT_SAYS(refused<InvalidInput>("mesh.feb", model(kNodes)), "no tetrahedra of 4 or 10 nodes");
  EXPECT_SAYS(refused<InvalidInput>("mesh.feb", model(kNodes + part("a", "<elem id='1'>1,2</elem>", "tet15"))),
              "no tetrahedra of 4 or 10 nodes");
  const std::string mesh = kNodes + part("new", "<elem id='9'>3,4,5,6</elem>");
  EXPECT_SAYS(refused<InvalidInput>("mesh.feb", model(mesh, "Mesh", "<!--label 3 is old-->")), "the part 'new'");
}

TEST_F(FebioMesh, DamageIsNamed) {
  EXPECT_SAYS(refused<IoError>("mesh.feb", "<febio_spec><Mesh>"), "as XML");
  EXPECT_SAYS(refused<IoError>("mesh.feb", "<other/>"), "no febio_spec");
  const auto message = [&](const std::string& elements) {
    return refused<IoError>("mesh.feb", model(kNodes + part("a", elements)));
  };
  EXPECT_SAYS(message("<elem id='9'>3,4,5</elem>"), "the elem '9' has '3,4,5'");
  EXPECT_SAYS(message("<elem id='9'>3,4,5,x</elem>"), "'x'");
  EXPECT_SAYS(message("<elem>3,4,5,6</elem>"), "the elem '' has ''");
  EXPECT_SAYS(message("<elem id='9'>3,4,5,7</elem>"), "to point 7");
}

}  // namespace
}  // namespace anatomesh::testing
