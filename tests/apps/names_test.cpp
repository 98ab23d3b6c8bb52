// Names of labels and several masks on the command line.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "anatomesh/io.h"
#include "apps/process.h"
#include "support/test_images.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Expects every part in the text.
void expect_said(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

/// Nested spheres of labels 3, 70000 and 4294967295, and a table with names for two of them.
class Names : public ::testing::Test {
 protected:
  void SetUp() override {
    write_label_image(image_, nested_spheres());
    write_file(table_, "label,name,r,g,b\n3,Große Hülle,1,2,3\n70000,core,4,5,6\n5,not there\n");
  }

  fs::path mask(const std::string& name, Label label) const {
    LabelImage image = nested_spheres();
    for (Label& voxel : image.voxels) voxel = voxel == label ? 1 : 0;
    write_label_image(folder_ / name, image);
    return folder_ / name;
  }

  ScratchFolder folder_;
  fs::path image_ = folder_ / "image.nrrd";
  fs::path mesh_ = folder_ / "mesh.vtu";
  fs::path table_ = folder_ / "names.csv";
};

TEST_F(Names, of_a_table_are_in_mesh_tables_and_reports) {
  const fs::path report = folder_ / "report.json", check = folder_ / "check.json";
  const ProcessResult made = run_program({"mesh", image_, "-o", mesh_, "--names", table_, "--report", report});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.err.find("warning"), std::string::npos) << made.err;
  const LabelTable expected = {{3, {"Große Hülle", Colour{1, 2, 3}}}, {70000, {"core", Colour{4, 5, 6}}}};
  EXPECT_EQ(read_mesh(mesh_).names, expected);

  const ProcessResult checked = run_program({"check", mesh_, "--image", image_, "--json", check});
  EXPECT_EQ(checked.status, 0);
  expect_said(checked.out, {"    tissue  name", "         3  Große Hülle  ", "     70000  core         ",
                            "4294967295               "});
  for (const Json& tissues :
       {Json::parse(read_file(report)).at("tissues"), Json::parse(read_file(report)).at("assessment").at("tissues"),
        Json::parse(read_file(check)).at("assessment").at("tissues")}) {
    EXPECT_EQ(tissues.at(0).at("name"), "Große Hülle");
    EXPECT_EQ(tissues.at(1).at("label"), 70000);
    EXPECT_EQ(tissues.at(1).at("name"), "core");
    EXPECT_TRUE(tissues.at(2).at("name").is_null());
  }
}

TEST_F(Names, of_a_table_win_over_those_of_a_mesh) {
  ASSERT_EQ(run_program({"mesh", image_, "-o", mesh_, "--names", table_}).status, 0);
  const fs::path other = folder_ / "other.txt", converted = folder_ / "converted.vtk";
  write_file(other, "3 skull\n4294967295 brain 9 8 7 255\n");
  const ProcessResult result = run_program({"convert", mesh_, converted, "--names", other});
  EXPECT_EQ(result.status, 0) << result.err;
  const LabelTable expected = {
      {3, {"skull", Colour{1, 2, 3}}}, {70000, {"core", Colour{4, 5, 6}}}, {4294967295, {"brain", Colour{9, 8, 7}}}};
  EXPECT_EQ(read_mesh(converted).names, expected);
  EXPECT_EQ(run_program({"convert", mesh_, folder_ / "plain.vtk"}).status, 0);
  EXPECT_EQ(read_mesh(folder_ / "plain.vtk").names, read_mesh(mesh_).names);
}

TEST_F(Names, of_other_labels_are_warned_about) {
  write_file(table_, "1,a\n2,b\n");
  const ProcessResult made = run_program({"mesh", image_, "-o", mesh_, "--names", table_});
  EXPECT_EQ(made.status, 0);
  expect_said(made.err, {"warning", "names.csv", "none of the labels", "image.nrrd"});
  const ProcessResult converted = run_program({"convert", mesh_, folder_ / "mesh.vtk", "--names", table_});
  EXPECT_EQ(converted.status, 0);
  expect_said(converted.err, {"warning", "names.csv", "mesh.vtu"});
}

TEST_F(Names, of_a_bad_table_end_the_command_before_its_work) {
  write_file(table_, "1,a\ntwo,b\n");
  const ProcessResult made = run_program({"mesh", image_, "-o", mesh_, "--names", table_});
  EXPECT_EQ(made.status, 3);
  expect_said(made.err, {"line 2", "names.csv", "'two'"});
  EXPECT_FALSE(fs::exists(mesh_));
  const ProcessResult missing = run_program({"mesh", image_, "-o", mesh_, "--names", folder_ / "none.csv"});
  EXPECT_EQ(missing.status, 3);
  expect_said(missing.err, {"none.csv"});
  const std::string before = read_file(table_);
  const ProcessResult same = run_program({"mesh", image_, "-o", mesh_, "--report", table_, "--names", table_});
  EXPECT_EQ(same.status, 2);
  EXPECT_EQ(read_file(table_), before);
}

TEST_F(Names, of_masks_are_those_of_their_files) {
  const fs::path skin = mask("skin.nii.gz", 3), core = mask("core.nrrd", 70000), report = folder_ / "report.json";
  const ProcessResult made = run_program({"mesh", skin, core, "-o", mesh_, "--report", report});
  ASSERT_EQ(made.status, 0) << made.err;
  expect_said(made.out, {"2 of 2 meshed", "core)", "--image " + skin.string() + " " + core.string()});
  const TetMesh mesh = read_mesh(mesh_);
  EXPECT_EQ(std::set<Label>(mesh.labels.begin(), mesh.labels.end()), (std::set<Label>{1, 2}));
  EXPECT_EQ(mesh.names, (LabelTable{{1, {"skin", {}}}, {2, {"core", {}}}}));
  EXPECT_EQ(Json::parse(read_file(report)).at("image").at("files").at(1), core.string());
  EXPECT_EQ(run_program({"check", mesh_, "--image", skin, core}).status, 0);
  EXPECT_EQ(run_program({"check", "--image", skin, core, mesh_}).status, 0);
  expect_said(run_program({"check", mesh_, "--image", core, skin}).out, {"0.002 smallest"});  // of Dice
}

TEST_F(Names, of_masks_that_do_not_fit_are_in_the_error) {
  LabelImage moved = nested_spheres();
  for (Label& voxel : moved.voxels) voxel = voxel == 3 ? 1 : 0;
  moved.origin_mm.x += 5;
  write_label_image(folder_ / "moved.nrrd", moved);
  const fs::path skin = mask("skin.nii.gz", 3);
  const ProcessResult apart = run_program({"mesh", skin, folder_ / "moved.nrrd", "-o", mesh_});
  EXPECT_EQ(apart.status, 3);
  expect_said(apart.err, {"skin.nii.gz", "moved.nrrd", "origin"});
  const ProcessResult labels = run_program({"mesh", skin, image_, "-o", mesh_});
  EXPECT_EQ(labels.status, 3);
  expect_said(labels.err, {"image.nrrd", "mask", "70000"});
  const ProcessResult over = run_program({"mesh", skin, image_, "-o", image_});
  EXPECT_EQ(over.status, 2);
  EXPECT_FALSE(fs::exists(mesh_));
}

TEST_F(Names, of_an_image_are_in_info) {
  std::string segmentation =
      "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\nencoding: raw\n"
      "space origin: (0,0,0)\nSegment0_ID:=s1\nSegment0_Name:=left kidney\nSegment0_LabelValue:=4\n"
      "Segment0_Layer:=0\n\n";
  write_file(folder_ / "a.seg.nrrd", segmentation.append("\4\4\0\0\1\0\0\0", 8));
  const ProcessResult result = run_program({"info", folder_ / "a.seg.nrrd"});
  EXPECT_EQ(result.status, 0) << result.err;
  expect_said(result.out, {"label  voxels  volume ml  name\n", "    4       2      0.002  left kidney\n",
                           "    1       1      0.001  \n"});
}

}  // namespace
}  // namespace anatomesh::testing
