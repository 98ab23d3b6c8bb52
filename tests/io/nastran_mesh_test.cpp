#include "io/nastran_mesh.h"

#include <cmath>
#include <limits>
#include <random>

#include "io/solver_fixture.h"

namespace anatomesh::testing {
namespace {

using NastranMesh = SolverFile;

TEST_F(NastranMesh, HasLargeFields) {
  const std::string text = written("mesh.bdf", two_named_tissues());
  EXPECT_SAYS(text, "BEGIN BULK\nPSOLID  3       3\nPSOLID  17      17\n");
  EXPECT_SAYS(text, "\nGRID*   4                               0.              0.              \n*       .3333333");
  EXPECT_SAYS(text, "\nCTETRA  2       3       1       2       3       4       \nENDDATA\n");
}

TEST_F(NastranMesh, AllBitsComeBack) {
  TetMesh mesh = two_named_tissues();
  std::mt19937_64 random(7);
  for (Vec3& point : mesh.points_mm) {
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = std::generate_canonical<double, 53>(random) * 200 - 100;
  }
  EXPECT_EQ(mesh_in("copy.bdf", written("mesh.bdf", mesh)).points_mm, mesh.points_mm);
}

TEST_F(NastranMesh, ChangedPointsAreNotChangedBack) {
  const TetMesh mesh = two_named_tissues();
  std::string text = written("mesh.bdf", mesh);
  text.replace(text.find(".333333333333333\n"), 4, ".444");
  EXPECT_EQ(mesh_in("copy.bdf", text).points_mm[3].z, 0.444333333333333);
}

TEST_F(NastranMesh, RealsLieNextToTheirValue) {
  EXPECT_EQ(nastran_real(0), "0.");
  EXPECT_EQ(nastran_real(-2), "-2.");
  EXPECT_EQ(nastran_real(-31.257891234567891), "-31.257891234568");
  EXPECT_EQ(nastran_real(-1.0 / 3), "-.33333333333333");
  EXPECT_EQ(nastran_real(1e-9), ".000000001");
  EXPECT_EQ(nastran_real(1.25e20), "1.2500000000E+20");
  std::mt19937_64 random(5);
  for (int n = 0; n < 20000; ++n) {
    const double value = std::ldexp(std::generate_canonical<double, 53>(random) - 0.5, static_cast<int>(n % 200) - 100);
    const std::string text = nastran_real(value);
    EXPECT_LE(text.size(), 16U) << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
    EXPECT_LE(std::abs(std::stod(text) - value), std::max(1e-14, std::abs(value) * 1e-9)) << text;
    const bool is_usual = std::abs(value) > 1 && std::abs(value) < 1e6;
    EXPECT_NEAR(std::stod(text) / value, 1, is_usual ? 1e-13 : 1e-8) << text;
  }
}

TEST_F(NastranMesh, OfOtherTools) {
  const std::string text =
      "SOL 101\nTITLE = GRID, of something\nCEND\nBEGIN BULK\n"
      "GRID,11,,1.5,2.5-1,-.5D+1\n"
      "GRID          12              1.      2.      3.\n"
      "$ a comment\n"
      "GRID*,13,,1.,2.\n*,4.\n"
      "GRID*                 14               0             1.0           2.0E0*A\n"
      "$ between\n"
      "*A                  -2.5\n"
      "CTRIA3,1,1,11,12,13\n"
      "CTETRA* 8               5               11              12\n*       13              14\n"
      "CTETRA,7,+6,11,13,12,14\n"
      "ENDDATA\nnothing of this is read";
  const TetMesh mesh = mesh_in("mesh.bdf", text);
  EXPECT_EQ(mesh.points_mm, (std::vector<Vec3>{{1.5, 0.25, -5}, {1, 2, 3}, {1, 2, 4}, {1, 2, -2.5}}));
  EXPECT_EQ(mesh.tets, (std::vector<std::array<VertexId, 4>>{{0, 2, 1, 3}, {0, 1, 2, 3}}));
  EXPECT_EQ(mesh.labels, (std::vector<Label>{6, 5}));
}

TEST_F(NastranMesh, FilesToBeIncludedHaveNoEnd) {
  const std::string points = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\n";
  EXPECT_EQ(mesh_in("mesh.bdf", points + "CTETRA,1,,1,2,3,4").labels, std::vector<Label>{1});
}

TEST_F(NastranMesh, WhatCannotBeReadIsNamed) {
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "BEGIN BULK\nINCLUDE 'nodes.bdf'\nENDDATA\n"), "another file");
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "GRID,1,5,0.,0.,0.\n"), "coordinate system 5");
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "GRDSET,,7\n"), "coordinate system 7");
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "GRID,1,,0.,0.,0.\n"), "no tetrahedra of 4 or 10 nodes");
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "CTETRA,1,1,1,2,3,4,5,6\n+,7\n"), "3 edge nodes of tetrahedron 1");
  EXPECT_SAYS(refused<InvalidInput>("mesh.bdf", "CTETRA,1,-1,1,2,3,4\n"), "property -1");
}

TEST_F(NastranMesh, DamageIsNamed) {
  EXPECT_SAYS(refused<IoError>("mesh.bdf", "GRID,1,,0.,zero,0.\n"), "'zero'");
  EXPECT_SAYS(refused<IoError>("mesh.bdf", "BEGIN BULK\nGRID,1,,0.,0.,0.\n"), "ends too early");
  EXPECT_SAYS(refused<IoError>("mesh.bdf", "CTETRA,1,1,1,2,3\n"), "ends too early");
  EXPECT_SAYS(refused<IoError>("mesh.bdf", "CTETRA,1,1,1,2,3,4\n"), "to point 1");
}

TEST_F(NastranMesh, LabelsBeginAtOne) {
  TetMesh mesh = two_named_tissues();
  mesh.labels[0] = 0;
  const auto file = in_folder("mesh.bdf");
  EXPECT_SAYS(message_of<InvalidInput>(file, [&] { write_mesh(file, mesh); }), "label 0");
  EXPECT_EQ(folder_listing(), "");
}

}  // namespace
}  // namespace anatomesh::testing
