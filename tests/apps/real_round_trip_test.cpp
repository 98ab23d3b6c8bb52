// Meshes of real images through every format and back: atlases of many labels, with values that some formats cannot
// hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/io.h"
#include "apps/process.h"
#include "io/mesh_format.h"
#include "support/shared_data.h"

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

/// An atlas and what of it is meshed, coarsely: it is files that are tested here.
struct Atlas {
  const char* file;
  double bcc_size_mm;
  Label smallest = 1;  ///< labels below this are left out
  std::size_t labels;  ///< that are left
  Label largest;
};

std::ostream& operator<<(std::ostream& out, const Atlas& atlas) { return out << atlas.file; }

constexpr std::array kAtlases = {Atlas{"aal.nii.gz", 32, 1, 116, 116},
                                 Atlas{"spl_brain_hncma_atlas.nrrd", 32, 1, 312, 4100},
                                 Atlas{"gubra_mouse_brain_large_uint32.nii.gz", 64, 1100, 34, 614454277}};

std::vector<Label> labels_of(const LabelImage& image, Label smallest) {
  std::vector<Label> labels = image.voxels;
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());  // runs first: it is a long list
  const std::set<Label> sorted(labels.begin(), labels.end());
  return {sorted.lower_bound(smallest), sorted.end()};
}

Options coarse(const Atlas& atlas, const std::vector<Label>& labels) {
  Options options;
  options.labels = labels;
  options.lattice.bcc_size_mm = atlas.bcc_size_mm;
  options.lattice.fidelity = 0.3;
  options.lattice.fidelity_stage = FidelityStage::lattice;
  options.lattice.allow_non_manifold = true;
  options.deform.iterations = 1;  // without, coordinates would be round numbers
  return options;
}

/// Names that formats and parsers may stumble over; of every fifth label none at all.
LabelTable names_for(const std::vector<Label>& labels) {
  constexpr std::array kNames = {"Région frontale n°", "脑干, μ-Kern & <co>", "a \"quoted\" name", "Left_hippocampus"};
  LabelTable table;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    if (n % 5 == kNames.size()) continue;
    const Colour colour = {255, static_cast<std::uint8_t>(n % 256), 0};
    table[labels[n]] = {std::string(kNames[n % 5]).append(" ").append(std::to_string(n)), colour};
  }
  return table;
}

TetMesh named_mesh(const Atlas& atlas, const fs::path& path) {
  const LabelImage image = read_label_image(path).image;
  const std::vector<Label> labels = labels_of(image, atlas.smallest);
  EXPECT_EQ(labels.size(), atlas.labels);
  EXPECT_EQ(labels.back(), atlas.largest);
  TetMesh mesh = image_to_mesh(image, coarse(atlas, labels)).mesh;
  EXPECT_EQ(std::set<Label>(mesh.labels.begin(), mesh.labels.end()), std::set<Label>(labels.begin(), labels.end()));
  mesh.names = names_for(labels);
  return mesh;
}

/// The table as far as the format keeps it: docs/formats.md.
LabelTable kept_by(const MeshFormat& format, LabelTable table) {
  constexpr std::array<std::string_view, 3> kKeepColours = {".vtu", ".vtk", ".xdmf"};
  const bool keeps_colours = std::ranges::find(kKeepColours, format.extension) != kKeepColours.end();
  for (auto& [label, entry] : table) {
    if (!keeps_colours) entry.colour.reset();
    if (format.extension == ".msh") std::ranges::replace(entry.name, '"', '_');  // they end a name there
  }
  return table;
}

// Not by EXPECT_EQ, which would print a hundred thousand tetrahedra.
void expect_round_trip(const MeshFormat& format, const TetMesh& mesh, const fs::path& file) {
  write_mesh(file, mesh);
  const TetMesh read = read_mesh(file);
  EXPECT_TRUE(read.points_mm == mesh.points_mm);
  EXPECT_TRUE(read.tets == mesh.tets);
  EXPECT_TRUE(read.labels == mesh.labels);
  const LabelTable expected = kept_by(format, mesh.names);
  EXPECT_EQ(read.names.size(), expected.size());
  for (const auto& [label, entry] : expected) {
    ASSERT_TRUE(read.names.contains(label)) << label;
    EXPECT_EQ(read.names.at(label).name, entry.name);
    EXPECT_TRUE(read.names.at(label).colour == entry.colour) << label;
  }
}

/// In the library an exception, in the program status 3; both name the label and the largest that would do.
void expect_refusal(const MeshFormat& format, const TetMesh& mesh, const fs::path& stored, const fs::path& file) {
  const std::string label = "the label " + std::to_string(std::ranges::max(mesh.labels));
  const std::string limit = "labels up to " + std::to_string(format.largest_label);
  try {
    write_mesh(file, mesh);
    ADD_FAILURE() << "no exception";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(label), std::string::npos) << error.what();
  }
  const ProcessResult converted = run_program({"convert", stored, file});
  EXPECT_EQ(converted.status, 3);
  EXPECT_NE(converted.err.find(label), std::string::npos) << converted.err;
  EXPECT_NE(converted.err.find(limit), std::string::npos) << converted.err;
  EXPECT_FALSE(fs::exists(file));
}

class RealRoundTrip : public ::testing::TestWithParam<Atlas> {};

TEST_P(RealRoundTrip, EveryFormatKeepsAllItCanHold) {
  const Atlas& atlas = GetParam();
  const fs::path path = find_image(atlas.file);
  if (path.empty()) GTEST_SKIP() << atlas.file << " is not on this machine";
  const TetMesh mesh = named_mesh(atlas, path);
  const ScratchFolder folder;
  const fs::path stored = folder / "stored.vtu";
  write_mesh(stored, mesh);
  for (const MeshFormat& format : mesh_formats()) {
    if (format.read == nullptr) continue;
    SCOPED_TRACE(format.extension);
    const fs::path file = folder / std::string("mesh").append(format.extension);
    if (atlas.largest > format.largest_label) {
      expect_refusal(format, mesh, stored, file);
    } else {
      expect_round_trip(format, mesh, file);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Atlases, RealRoundTrip, ::testing::ValuesIn(kAtlases));

}  // namespace
}  // namespace anatomesh::testing
