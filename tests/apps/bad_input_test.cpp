// Everything that can be wrong with what the user hands over: one clear message, the right exit status, nothing
// half-written.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "anatomesh/io.h"
#include "apps/process.h"
#include "apps/raw_images.h"
#include "support/test_images.h"
#include "support/test_meshes.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOldMesh = "an older mesh";

/// The error stream without the plain progress lines.
std::vector<std::string> error_lines(const std::string& err) {
  std::vector<std::string> lines;
  std::istringstream stream(err);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("anatomesh: error: ")) lines.push_back(line);
  return lines;
}

void expect_one_error(const ProcessResult& result, int status, const std::vector<std::string>& said) {
  EXPECT_EQ(result.status, status) << result.err;
  EXPECT_EQ(result.out, "");
  ASSERT_EQ(error_lines(result.err).size(), 1u) << result.err;
  for (const std::string& part : said)
    EXPECT_NE(error_lines(result.err)[0].find(part), std::string::npos) << result.err;
}

/// A command that fails must leave the folder as it was.
void expect_failure_leaves_folder(const ScratchFolder& folder, const std::vector<std::string>& arguments, int status,
                                  const std::vector<std::string>& said, const ProcessSettings& settings = {}) {
  const auto before = folder.files();
  expect_one_error(run_program(arguments, settings), status, said);
  EXPECT_EQ(folder.files(), before);
}

// ---- images ---------------------------------------------------------------------------------------------------

struct BadImage {
  std::string name;
  std::string file_name;
  std::function<void(const fs::path&)> write;
  std::vector<std::string> said;  ///< parts of the message beside the file's name
};

std::function<void(const fs::path&)> text(const std::string& bytes) {
  return [bytes](const fs::path& path) { write_file(path, bytes); };
}

void write_unreadable(const fs::path& path) {
  write_file(path, Nrrd().file());
  fs::permissions(path, fs::perms::none);
}

/// A header, and voxels that take no place on the disk but 64 terabytes in memory.
void write_huge(const fs::path& path) {
  const fs::path voxels = path.parent_path() / "huge.raw";
  write_file(path, MetaImage{.size = "16000 16000 16000", .data_file = "huge.raw"}.file());
  write_file(voxels, "");
  fs::resize_file(voxels, std::uintmax_t{16000} * 16000 * 16000);
}

std::vector<BadImage> bad_images() {
  const std::string good = Nrrd().file();
  std::vector<float> fractional(64, 1.0F);
  fractional[20] = 2.5F;
  std::vector<std::int16_t> negative(64, 1);
  negative[7] = -3;
  return {
      {"missing", "missing.nii", [](const fs::path&) {}, {"no file"}},
      {"empty", "empty.nii", text(""), {}},
      {"truncated_nrrd", "cut.nrrd", text(good.substr(0, good.size() - 30)), {}},
      {"truncated_nifti", "cut.nii", text(Nifti().file().substr(0, 370)), {}},
      {"truncated_header", "cut_header.nii", text(Nifti().file().substr(0, 100)), {}},
      {"truncated_mgh", "cut.mgh", text(std::string("\0\0\0\1\0\0\0\4", 8)), {"284"}},
      {"mgh_that_is_none", "notes.mgz", text(std::string(300, 'x')), {"version"}},
      {"unreadable", "locked.nrrd", write_unreadable, {}},
      {"not_an_image", "notes.nii", text("these are notes, not an image\n"), {}},
      {"unknown_extension", "notes.txt", text("these are notes, not an image\n"), {}},
      {"two_dimensional",
       "flat.nrrd",
       text(Nrrd{.sizes = "8 8", .directions = "(1,0,0) (0,1,0)", .kinds = "domain domain"}.file()),
       {"3"}},
      {"four_dimensional",
       "series.nii",
       text(Nifti{.dim = {4, 4, 4, 4, 2, 1, 1, 1}, .data = std::string(128, '\1')}.file()),
       {"3"}},
      {"vector_pixels", "colours.mha", text(MetaImage{.channels = "3", .data = std::string(192, '\1')}.file()), {"3"}},
      {"fractional", "intensities.nrrd", text(Nrrd{.type = "float", .data = bytes_of(fractional)}.file()), {"2.5"}},
      {"negative", "signed.nrrd", text(Nrrd{.type = "int16", .data = bytes_of(negative)}.file()), {"-3"}},
      {"all_background", "void.nrrd", text(Nrrd{.data = std::string(64, '\0')}.file()), {}},
      {"zero_spacing", "zero.nrrd", text(Nrrd{.directions = "(1,0,0) (0,0,0) (0,0,1)"}.file()), {"0"}},
      {"zero_spacing_meta", "zero.mha", text(MetaImage{.spacing = "1 0 1"}.file()), {"0"}},
      {"negative_spacing", "negative.mha", text(MetaImage{.spacing = "1 -2 1"}.file()), {"-2"}},
      {"nan_spacing", "nan.nrrd", text(Nrrd{.directions = "(1,0,0) (0,nan,0) (0,0,1)"}.file()), {}},
      {"nan_spacing_nifti", "nan.nii", text(Nifti{.pixdim = {1, 1, NAN, 1, 1, 1, 1, 1}}.file()), {}},
      {"sheared_direction",
       "sheared.nrrd",
       text(Nrrd{.directions = "(1,0,0) (0.5,1,0) (0,0,1)"}.file()),
       {"direction"}},
      {"too_large_for_memory", "huge.mhd", write_huge, {"memory"}},
  };
}

class BadImageTest : public ::testing::TestWithParam<BadImage> {};

TEST_P(BadImageTest, is_refused_by_mesh_and_info) {
  const ScratchFolder folder;
  const fs::path image = folder / GetParam().file_name, mesh = folder / "mesh.vtu", report = folder / "report.json";
  GetParam().write(image);
  const ProcessSettings settings = {.without_privileges = true};
  std::vector<std::string> said = {image.filename().string()};
  said.insert(said.end(), GetParam().said.begin(), GetParam().said.end());
  const bool huge = GetParam().name == "too_large_for_memory";  // its voxels are too many to compare
  const std::vector<std::string> arguments = {"mesh", image, "-o", mesh, "--report", report};

  if (!huge) expect_failure_leaves_folder(folder, arguments, 3, said, settings);
  if (huge) expect_one_error(run_program(arguments, settings), 3, said);
  EXPECT_FALSE(fs::exists(mesh));
  EXPECT_FALSE(fs::exists(report));

  write_file(mesh, kOldMesh);
  expect_one_error(run_program(arguments, settings), 3, said);
  EXPECT_EQ(read_file(mesh), kOldMesh);

  if (GetParam().name != "all_background") expect_one_error(run_program({"info", image}, settings), 3, said);
}

INSTANTIATE_TEST_SUITE_P(images, BadImageTest, ::testing::ValuesIn(bad_images()),
                         [](const auto& test) { return test.param.name; });

TEST(FewVoxels, one_voxel_is_meshed) {
  const ScratchFolder folder;
  for (const LabelImage& image : {one_voxel(), only_one_voxel()}) {
    write_label_image(folder / "image.nrrd", image);
    const ProcessResult result = run_program({"mesh", folder / "image.nrrd", "-o", folder / "mesh.vtu"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_GT(read_mesh(folder / "mesh.vtu").tets.size(), 0u);
  }
}

// ---- usage ----------------------------------------------------------------------------------------------------

struct WrongUsage {
  std::vector<std::string> arguments;  ///< after `mesh IMAGE -o MESH`
  std::vector<std::string> said;
};

const std::vector<WrongUsage>& wrong_usages() {
  static const std::vector<WrongUsage> all = {
      {{"--unknown-option"}, {"--unknown-option"}},
      {{"--fidelity", "1.5"}, {"fidelity", "1.5", "1"}},
      {{"--fidelity", "0"}, {"fidelity", "0"}},
      {{"--fidelity", "-0.5"}, {"fidelity", "-0.5"}},
      {{"--fidelity", "nan"}, {"--fidelity", "nan", "number"}},
      {{"--fidelity", "high"}, {"--fidelity", "high", "number"}},
      {{"--fidelity"}, {"--fidelity"}},
      {{"--bcc-size", "-1"}, {"--bcc-size", "-1"}},
      {{"--bcc-size", "inf"}, {"--bcc-size", "inf"}},
      {{"--bcc-size", "2", "--min-size", "4"}, {"--min-size", "4", "--bcc-size", "2"}},
      {{"--min-size", "nan"}, {"--min-size", "nan"}},
      {{"--iterations", "-1"}, {"iterations", "-1"}},
      {{"--iterations", "2.5"}, {"--iterations", "2.5", "whole"}},
      {{"--iterations", "99999999999999"}, {"--iterations", "99999999999999"}},
      {{"--min-dihedral", "31"}, {"--min-dihedral", "31", "30"}},
      {{"--max-dihedral", "100"}, {"--max-dihedral", "100", "117"}},
      {{"--min-mean-ratio", "0.9"}, {"--min-mean-ratio", "0.9", "0.5"}},
      {{"--non-connectivity", "corner"}, {"--non-connectivity", "corner", "vertex|edge|face|none"}},
      {{"--frame", "xyz"}, {"--frame", "xyz", "lps|ras"}},
      {{"--threads", "-2"}, {"threads", "-2"}},
      {{"--max-memory", "-1"}, {"--max-memory", "-1"}},
      {{"--young", "3=0"}, {"--young", "0"}},
      {{"--tissue", "3=stone"}, {"--tissue", "stone", "brain|ventricle"}},
      {{"--tissue", "99=brain"}, {"--tissue", "99", "3, 70000, 4294967295"}},
      {{"--poisson", "3=0.5"}, {"--poisson", "0.5"}},
      {{"--poisson", "0.7"}, {"--poisson", "0.7"}},
      {{"--young", "99=500"}, {"--young", "99", "3, 70000, 4294967295"}},
      {{"--fidelity-label", "99=0.9"}, {"--fidelity-label", "99", "3, 70000, 4294967295"}},
      {{"--fidelity-label", "3=1.1"}, {"--fidelity-label", "1.1"}},
      {{"--fidelity-label", "0.9"}, {"--fidelity-label", "LABEL=F"}},
      {{"--fidelity-label", "bone=0.9"}, {"--fidelity-label", "bone"}},
      {{"--labels", "99"}, {"--labels", "99", "3, 70000, 4294967295"}},
      {{"--labels", "4-69999"}, {"--labels", "4-69999", "3, 70000, 4294967295"}},
      {{"--labels", "5-2"}, {"--labels", "5-2", "2-5"}},
      {{"--labels", "3,,4"}, {"--labels", "''"}},
      {{"--labels", "0"}, {"--labels", "'0'"}},
      {{"--labels", "4294967296"}, {"--labels", "4294967296", "4294967295"}},
      {{"--labels", ""}, {"--labels"}},
  };
  return all;
}

TEST(WrongUsage, of_mesh_options_ends_with_status_2) {
  const ScratchFolder folder;
  const fs::path image = folder / "image.nrrd", mesh = folder / "mesh.vtu";
  write_label_image(image, nested_spheres());
  write_file(mesh, kOldMesh);
  for (const auto& [arguments, said] : wrong_usages()) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    std::vector<std::string> all = {"mesh", image, "-o", mesh};
    all.insert(all.end(), arguments.begin(), arguments.end());
    expect_failure_leaves_folder(folder, all, 2, said);
  }
}

TEST(WrongUsage, of_commands_ends_with_status_2) {
  const std::vector<WrongUsage> usages = {
      {{}, {"command", "mesh"}},
      {{"mash"}, {"mash", "mesh"}},
      {{"mesh"}, {"IMAGE"}},
      {{"mesh", "image.nii"}, {"--output"}},
      {{"mesh", "image.nii", "-o", "mesh.docx"}, {"mesh.docx", ".vtu"}},
      {{"convert", "mesh.vtu"}, {"OUT"}},
      {{"convert", "mesh.vtu", "mesh.docx"}, {"mesh.docx", ".vtu"}},
      {{"convert", "mesh.vtu", "out.vtu", "--names"}, {"--names"}},
      {{"convert", "mesh.vtu", "mesh.vtk", "--per-tissue"}, {"mesh.vtk", ".stl"}},
      {{"check"}, {"MESH"}},
      {{"check", "mesh.vtu", "--labels", "1"}, {"--image"}},
      {{"check", "mesh.vtu", "--min-dihedral", "steep"}, {"--min-dihedral", "steep"}},
      {{"info"}, {"IMAGE"}},
  };
  for (const auto& [arguments, said] : usages) {
    SCOPED_TRACE(::testing::PrintToString(arguments));
    expect_one_error(run_program(arguments), 2, said);
  }
}

// ---- outputs --------------------------------------------------------------------------------------------------

class BadOutput : public ::testing::Test {
 protected:
  void SetUp() override { write_label_image(folder_ / "image.nrrd", nested_spheres()); }

  std::vector<std::string> mesh_to(const fs::path& mesh) const { return {"mesh", folder_ / "image.nrrd", "-o", mesh}; }

  ScratchFolder folder_;
};

TEST_F(BadOutput, missing_folder) {
  expect_failure_leaves_folder(folder_, mesh_to(folder_ / "nowhere" / "mesh.vtu"), 3, {"nowhere"});
}

TEST_F(BadOutput, folder_in_its_place) {
  fs::create_directory(folder_ / "mesh.vtu");
  expect_failure_leaves_folder(folder_, mesh_to(folder_ / "mesh.vtu"), 3, {"mesh.vtu"});
}

TEST_F(BadOutput, unwritable_folder) {
  const fs::path locked = folder_ / "locked";
  fs::create_directory(locked);
  fs::permissions(locked, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_exec);
  expect_failure_leaves_folder(folder_, mesh_to(locked / "mesh.vtu"), 3, {"locked"}, {.without_privileges = true});
  EXPECT_TRUE(fs::is_empty(locked));
}

TEST_F(BadOutput, unwritable_report_is_found_before_the_work) {
  auto arguments = mesh_to(folder_ / "mesh.vtu");
  arguments.insert(arguments.end(), {"--report", folder_ / "nowhere" / "report.json"});
  expect_failure_leaves_folder(folder_, arguments, 3, {"nowhere"});
}

TEST_F(BadOutput, full_disk) {
  write_file(folder_ / "mesh.vtu", kOldMesh);
  expect_failure_leaves_folder(folder_, mesh_to(folder_ / "mesh.vtu"), 3, {"mesh.vtu"}, {.max_file_bytes = 5000});
  expect_failure_leaves_folder(folder_, mesh_to(folder_ / "new.vtk"), 3, {"new.vtk"}, {.max_file_bytes = 5000});
}

TEST_F(BadOutput, more_memory_than_allowed) {
  auto arguments = mesh_to(folder_ / "mesh.vtu");
  arguments.insert(arguments.end(), {"--max-memory", "0.000001"});
  expect_failure_leaves_folder(folder_, arguments, 3, {"image.nrrd", "memory"});
}

// ---- meshes ---------------------------------------------------------------------------------------------------

TEST(BadMesh, is_refused_by_check_and_convert) {
  const ScratchFolder folder;
  write_mesh(folder / "good.vtu", corner_tet());
  const std::string good = read_file(folder / "good.vtu");
  write_file(folder / "cut.vtu", good.substr(0, good.size() / 2));
  write_file(folder / "notes.vtu", "these are notes, not a mesh\n");
  write_file(folder / "notes.vtk", "these are notes, not a mesh\n");
  for (const std::string name : {"missing.vtu", "cut.vtu", "notes.vtu", "notes.vtk"}) {
    SCOPED_TRACE(name);
    expect_failure_leaves_folder(folder, {"check", folder / name, "--json", folder / "check.json"}, 3, {name});
    expect_failure_leaves_folder(folder, {"convert", folder / name, folder / "out.vtk"}, 3, {name});
  }
}

}  // namespace
}  // namespace anatomesh::testing
