// What the commands do when all is well.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "anatomesh/io.h"
#include "apps/process.h"
#include "support/test_images.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Program, tells_its_version_and_its_commands) {
  EXPECT_EQ(run_program({"--version"}).out.rfind("anatomesh ", 0), 0u);
  const ProcessResult help = run_program({"--help"});
  EXPECT_EQ(help.status, 0);
  for (const char* command : {"mesh", "check", "convert", "info"}) {
    EXPECT_TRUE(contains(help.out, command)) << help.out;
    EXPECT_EQ(run_program({command, "--help"}).status, 0);
  }
}

TEST(Info, shows_place_and_labels) {
  const ScratchFolder folder;
  LabelImage image = left_handed(nested_spheres());
  image.spacing_mm = {2, 2, 2.5};
  write_label_image(folder / "image.nrrd", image);
  const ProcessResult result = run_program({"info", folder / "image.nrrd"});
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* part : {"29 x 29 x 29", "2 2 2.5", "40 -12.5 7", "RPS, left-handed", "4294967295", "70000", "1,852",
                           "18.520"})  // 1852 voxels of 10 mm3
    EXPECT_TRUE(contains(result.out, part)) << part << " in\n" << result.out;
}

class MeshAndCheck : public ::testing::Test {
 protected:
  void SetUp() override { write_label_image(image_, oblique(nested_spheres())); }

  ProcessResult mesh(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {"mesh", image_, "-o", mesh_};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_program(arguments);
  }

  std::vector<Label> labels_of_mesh() const {
    std::vector<Label> labels = read_mesh(mesh_).labels;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return labels;
  }

  ScratchFolder folder_;
  fs::path image_ = folder_ / "image.nrrd";
  fs::path mesh_ = folder_ / "mesh.vtu";
};

TEST_F(MeshAndCheck, all_is_well_by_default) {
  const ProcessResult made = mesh({});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_TRUE(contains(made.out, "3 of 3 meshed")) << made.out;
  EXPECT_TRUE(contains(made.out, "anatomesh check " + mesh_.string())) << made.out;
  EXPECT_EQ(labels_of_mesh(), (std::vector<Label>{3, 70000, 4294967295}));
  EXPECT_EQ(folder_.files().size(), 2u) << "nothing but the image and the mesh may be left";

  const ProcessResult checked = run_program({"check", mesh_, "--image", image_});
  EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
  for (const char* part : {"QUALITY", "FIDELITY", "TOPOLOGY", "4294967295", "every guarantee holds"})
    EXPECT_TRUE(contains(checked.out, part)) << checked.out;
}

TEST_F(MeshAndCheck, results_and_messages_keep_to_their_streams) {
  const ProcessResult quiet = mesh({"--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out, "");
  EXPECT_EQ(quiet.err, "");
  const ProcessResult verbose = mesh({"--verbose"});
  EXPECT_TRUE(contains(verbose.err, "anatomesh: write: ")) << verbose.err;
  EXPECT_FALSE(contains(verbose.err, "\r")) << "a bar is for terminals only";
}

TEST_F(MeshAndCheck, a_broken_bound_fails_the_check_and_is_named) {
  ASSERT_EQ(mesh({}).status, 0);
  const ProcessResult checked = run_program({"check", mesh_, "--image", image_, "--min-dihedral", "44"});
  EXPECT_EQ(checked.status, 1);
  EXPECT_TRUE(contains(checked.out, "FAILED")) << checked.out;
  EXPECT_TRUE(contains(checked.out, "44")) << checked.out;
}

TEST_F(MeshAndCheck, a_mesh_in_the_wrong_frame_fails_the_check) {
  ASSERT_EQ(mesh({"--frame", "ras"}).status, 0);
  EXPECT_EQ(run_program({"check", mesh_, "--image", image_, "--frame", "ras"}).status, 0);
  EXPECT_EQ(run_program({"check", mesh_, "--image", image_}).status, 1);
}

TEST_F(MeshAndCheck, chosen_labels_only) {
  ASSERT_EQ(mesh({"--labels", "3,60000-4294967294"}).status, 0);
  EXPECT_EQ(labels_of_mesh(), (std::vector<Label>{3, 70000}));
  EXPECT_EQ(run_program({"check", mesh_, "--image", image_}).status, 1) << "a label of the image is missing";
  EXPECT_EQ(run_program({"check", mesh_, "--image", image_, "--labels", "3,70000"}).status, 0);
}

TEST_F(MeshAndCheck, any_number_of_threads_writes_the_same_bytes) {
  ASSERT_EQ(mesh({"--threads", "1"}).status, 0);
  const std::string one = read_file(mesh_);
  ASSERT_EQ(mesh({"--threads", "3"}).status, 0);
  EXPECT_TRUE(read_file(mesh_) == one);
}

TEST_F(MeshAndCheck, the_report_holds_options_and_measures) {
  const fs::path report = folder_ / "report.json";
  ASSERT_EQ(mesh({"--report", report, "--fidelity-label", "70000=0.97", "--young", "3=500", "--tissue", "3=ventricle",
                  "--iterations", "3", "--bcc-size", "8"})
                .status,
            0);
  const Json json = Json::parse(read_file(report));
  EXPECT_EQ(json.at("options").at("deform").at("iterations"), 3);
  EXPECT_EQ(json.at("options").at("deform").at("material").at(0).at("young_modulus_pa"), 500);
  EXPECT_EQ(json.at("options").at("deform").at("material").at(0).at("poisson_ratio"), 0.1);
  EXPECT_EQ(json.at("options").at("lattice").at("bcc_size_mm"), 8);
  EXPECT_EQ(json.at("tissues").at(1).at("label"), 70000);
  EXPECT_EQ(json.at("tissues").at(1).at("fidelity"), 0.97);
  EXPECT_TRUE(json.at("tissues").at(2).at("label").is_number_unsigned());
  EXPECT_EQ(json.at("mesh").at("tets"), read_mesh(mesh_).tets.size());
  EXPECT_GT(json.at("assessment").at("whole").at("fidelity").at("dice"), 0.9);
  EXPECT_GT(json.at("assessment").at("summary").at("surface_mean_mm"), 0);
  EXPECT_EQ(json.at("assessment").at("tissues").size(), 3u);
  EXPECT_GE(json.at("times").size(), 3u);
}

TEST_F(MeshAndCheck, json_of_check_has_null_for_what_was_not_measured) {
  ASSERT_EQ(mesh({}).status, 0);
  const fs::path file = folder_ / "check.json";
  ASSERT_EQ(run_program({"check", mesh_, "--json", file}).status, 0);
  const Json json = Json::parse(read_file(file));
  EXPECT_TRUE(json.at("image").is_null());
  EXPECT_TRUE(json.at("assessment").at("summary").at("mean_dice").is_null());
  EXPECT_TRUE(json.at("assessment").at("tissues").at(0).at("fidelity").is_null());
  EXPECT_TRUE(json.at("failed_guarantees").empty());
}

TEST_F(MeshAndCheck, convert_keeps_all) {
  ASSERT_EQ(mesh({}).status, 0);
  const ProcessResult converted = run_program({"convert", mesh_, folder_ / "mesh.vtk"});
  EXPECT_EQ(converted.status, 0) << converted.err;
  const TetMesh a = read_mesh(mesh_), b = read_mesh(folder_ / "mesh.vtk");
  EXPECT_TRUE(a.points_mm == b.points_mm);
  EXPECT_TRUE(a.tets == b.tets);
  EXPECT_TRUE(a.labels == b.labels);
}

TEST_F(MeshAndCheck, convert_writes_a_surface_a_tissue) {
  ASSERT_EQ(mesh({}).status, 0);
  const ProcessResult converted = run_program({"convert", mesh_, folder_ / "ball.stl", "--per-tissue"});
  EXPECT_EQ(converted.status, 0) << converted.err;
  for (const Label label : labels_of_mesh()) {
    const std::string name = "ball_label_" + std::to_string(label) + ".stl";
    EXPECT_TRUE(contains(converted.out, name)) << converted.out;
    EXPECT_TRUE(fs::exists(folder_ / name)) << name;
  }
  EXPECT_FALSE(fs::exists(folder_ / "ball.stl"));
}

TEST_F(MeshAndCheck, an_output_is_never_an_input_or_another_output) {
  const std::string before = read_file(image_);
  const std::string link = folder_ / "link.vtu";
  fs::create_symlink(image_, link);
  const std::vector<std::vector<std::string>> clashes = {{"mesh", image_, "-o", mesh_, "--report", image_},
                                                         {"mesh", image_, "-o", mesh_, "--report", mesh_},
                                                         {"mesh", image_, "-o", link}};
  for (const auto& arguments : clashes) {
    const ProcessResult result = run_program(arguments);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_TRUE(contains(result.err, "the same file")) << result.err;
    EXPECT_EQ(read_file(image_), before);
    EXPECT_FALSE(fs::exists(mesh_));
  }
}

TEST_F(MeshAndCheck, a_pipe_is_no_output) {
  const std::string pipe = folder_ / "pipe.vtu";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(run_program({"mesh", image_, "-o", pipe}).status, 3);
  EXPECT_EQ(run_program({"info", pipe}).status, 3);
}

}  // namespace
}  // namespace anatomesh::testing
