#include <Anatomesh/MeshCache.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "anatomesh/image_to_mesh.h"
#include "anatomesh/interfaces.h"
#include "anatomesh/io.h"
#include "sofa_session.h"

namespace anatomesh::simulation {
namespace {

void expect_mesh(const TetrahedralMeshEngine& engine, const TetMesh& mesh) {
  const auto& position = engine.d_position.getValue();
  const auto& tetrahedra = engine.d_tetrahedra.getValue();
  ASSERT_EQ(position.size(), mesh.points_mm.size());
  ASSERT_EQ(tetrahedra.size(), mesh.tets.size());
  for (std::size_t p = 0; p < position.size(); ++p)
    for (unsigned a = 0; a < 3; ++a) ASSERT_EQ(position[p][a], mesh.points_mm[p][a]);
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
    ASSERT_TRUE(std::equal(mesh.tets[t].begin(), mesh.tets[t].end(), tetrahedra[t].begin()));
  EXPECT_TRUE(std::ranges::equal(engine.d_label.getValue(), mesh.labels));
}

TEST(ImageToTetrahedralMesh, OutputsAreThoseOfTheLibrary) {
  const auto mesher = mesher_of(two_balls());
  mesher->init();
  ASSERT_TRUE(is_valid(*mesher)) << errors_of(*mesher);
  const TetMesh mesh = image_to_mesh(two_balls()).mesh;
  expect_mesh(*mesher, mesh);
  std::size_t skin = 0, between = 0;
  for (const Interface& interface : interfaces_of(mesh))
    (interface.outside == 0 ? skin : between) += interface.faces.size();
  EXPECT_EQ(mesher->d_triangles.getValue().size(), skin);
  EXPECT_EQ(mesher->d_interfaceTriangles.getValue().size(), between);
  EXPECT_GT(between, 0u);
  ASSERT_EQ(mesher->d_interfaceLabels.getValue().size(), between);
  EXPECT_EQ(mesher->d_interfaceLabels.getValue()[0], (sofa::type::Vec<2, Label>(1, 7)));
}

TEST(ImageToTetrahedralMesh, SetsOfTissuesAndOfTheSurfaceFitTheMesh) {
  const auto mesher = mesher_of(two_balls());
  mesher->init();
  const auto& labels = mesher->d_tissueLabels.getValue();
  const auto& sets = mesher->d_tetrahedraInLabel.getValue();
  ASSERT_EQ(labels.size(), 2u);
  ASSERT_EQ(sets.size(), 2u);
  std::size_t all = 0;
  for (std::size_t n = 0; n < labels.size(); ++n) {
    for (const auto tet : sets[n]) EXPECT_EQ(mesher->d_label.getValue()[tet], labels[n]);
    all += sets[n].size();
  }
  EXPECT_EQ(all, mesher->d_tetrahedra.getValue().size());
  std::set<sofa::Index> corners;
  for (const auto& triangle : mesher->d_triangles.getValue()) corners.insert(triangle.begin(), triangle.end());
  EXPECT_TRUE(std::ranges::equal(mesher->d_surfacePoints.getValue(), corners));
}

TEST(ImageToTetrahedralMesh, MaterialsAreOneATetrahedron) {
  const auto mesher = mesher_of(two_balls());
  set(*mesher, "young", "1234 7=9000");
  set(*mesher, "poisson", "7=0.3");
  mesher->init();
  const auto& labels = mesher->d_label.getValue();
  ASSERT_EQ(mesher->d_youngModulus.getValue().size(), labels.size());
  ASSERT_EQ(mesher->d_poissonRatio.getValue().size(), labels.size());
  for (std::size_t t = 0; t < labels.size(); ++t) {
    EXPECT_EQ(mesher->d_youngModulus.getValue()[t], labels[t] == 7 ? 9000 : 1234);
    EXPECT_EQ(mesher->d_poissonRatio.getValue()[t], labels[t] == 7 ? 0.3 : 0.45);
  }
}

/// That of label 7; 0: none.
double of(const std::map<Label, double>& values) { return values.contains(7) ? values.at(7) : 0; }

struct OptionCase {
  const char* data;
  const char* text;
  std::function<bool(const Options&)> arrived;
};

const std::vector<OptionCase>& option_cases() {
  static const std::vector<OptionCase> all = {
      {"bccSize", "6", [](const Options& o) { return o.lattice.bcc_size_mm == 6; }},
      {"minSize", "0.7", [](const Options& o) { return o.lattice.min_size_mm == 0.7; }},
      {"fidelity", "0.8", [](const Options& o) { return o.lattice.fidelity == 0.8; }},
      {"fidelityLabel", "1=0.7 7=0.9", [](const Options& o) { return of(o.lattice.fidelity_label) == 0.9; }},
      {"fidelityStage", "lattice", [](const Options& o) { return o.lattice.fidelity_stage == FidelityStage::lattice; }},
      {"maxElements", "900", [](const Options& o) { return o.lattice.max_elements == 900 && o.lattice.fidelity == 1; }},
      {"sizeLabel", "7=2.5", [](const Options& o) { return of(o.lattice.size_label) == 2.5; }},
      {"elementsAcross", "3", [](const Options& o) { return o.lattice.elements_across == 3; }},
      {"dropIslands", "12", [](const Options& o) { return o.lattice.drop_islands == 12; }},
      {"allowNonManifold", "1", [](const Options& o) { return o.lattice.allow_non_manifold; }},
      {"nonConnectivity", "edge", [](const Options& o) { return o.deform.non_connectivity == NonConnectivity::edge; }},
      {"iterations", "4", [](const Options& o) { return o.deform.iterations == 4; }},
      {"gradation", "0.5", [](const Options& o) { return o.deform.gradation == 0.5; }},
      {"minDihedral", "12", [](const Options& o) { return o.deform.min_dihedral_deg == 12; }},
      {"maxDihedral", "160", [](const Options& o) { return o.deform.max_dihedral_deg == 160; }},
      {"minMeanRatio", "0.2", [](const Options& o) { return o.deform.min_mean_ratio == 0.2; }},
      {"frame", "ras", [](const Options& o) { return o.frame == Frame::ras; }},
      {"threads", "1", [](const Options& o) { return o.threads == 1; }},
      {"maxMemory", "3", [](const Options& o) { return o.max_memory_gib == 3; }},
  };
  return all;
}

TEST(ImageToTetrahedralMesh, EveryOptionArrives) {
  std::set<std::string> known = {"labels"};  // those are resolved with the image: the next test
  for (const OptionCase& option : option_cases()) {
    const auto mesher = mesher_of(two_balls());
    EXPECT_FALSE(option.arrived(options_of(mesher->options.request()))) << option.data;
    set(*mesher, option.data, option.text);
    EXPECT_TRUE(option.arrived(options_of(mesher->options.request()))) << option.data;
    known.insert(option.data);
  }
  const auto mesher = mesher_of(two_balls());
  for (const auto* data : mesher->options.all()) EXPECT_TRUE(known.contains(data->getName())) << data->getName();
}

TEST(ImageToTetrahedralMesh, OptionsAndMaterialsChangeTheMeshAsInTheLibrary) {
  const auto mesher = mesher_of(two_balls());
  const std::map<std::string, std::string> given = {
      {"bccSize", "6"}, {"labels", "5-9"}, {"frame", "ras"}, {"young", "7=9000"}, {"minDihedral", "10"}};
  for (const auto& [data, text] : given) set(*mesher, data, text);
  mesher->init();
  ASSERT_TRUE(is_valid(*mesher)) << errors_of(*mesher);
  Options options;
  options.lattice.bcc_size_mm = 6;
  options.labels = {7};
  options.frame = Frame::ras;
  options.deform.material[7] = {9000, 0.45};
  options.deform.min_dihedral_deg = 10;
  expect_mesh(*mesher, image_to_mesh(two_balls(), options).mesh);
}

TEST(ImageToTetrahedralMesh, DefaultsAreThoseOfTheLibrary) {
  const auto mesher = mesher_of(two_balls());
  EXPECT_EQ(content_hash({}, options_of(mesher->options.request())), content_hash({}, {}));
  EXPECT_EQ(mesher->options.d_fidelity.getValue(), Options().lattice.fidelity);
}

TEST(ImageToTetrahedralMesh, WorksAgainWhenAnInputChanges) {
  const auto mesher = mesher_of(two_balls());
  mesher->init();
  const auto before = mesher->d_tetrahedra.getValue().size();
  set(*mesher, "sizeLabel", "1=1.5 7=1.5");
  EXPECT_GT(mesher->d_tetrahedra.getValue().size(), before);
}

TEST(ImageToTetrahedralMesh, ReadsFilesOfOneImageAndOfMasks) {
  const TemporaryFolder folder;
  LabelImage image = two_balls();
  const auto write_label = [&](Label label, const char* name) {
    LabelImage mask = image;
    for (Label& voxel : mask.voxels) voxel = voxel == label ? 1 : 0;
    write_label_image(folder.path() / name, mask);
  };
  write_label_image(folder.path() / "two balls.nrrd", image);
  write_label(1, "outer.nrrd");
  write_label(7, "core.nrrd");
  const auto mesh_of = [&](const std::string& names) {
    const auto mesher = mesher_of({});
    set(*mesher, "filename", names);
    mesher->init();
    EXPECT_TRUE(is_valid(*mesher)) << errors_of(*mesher);
    return mesher;
  };
  const std::string at = folder.path().string() + "/";
  const auto one = mesh_of(at + "two balls.nrrd"), masks = mesh_of("['" + at + "outer.nrrd', '" + at + "core.nrrd']");
  EXPECT_TRUE(std::ranges::equal(one->d_tissueLabels.getValue(), std::vector<Label>{1, 7}));
  EXPECT_TRUE(std::ranges::equal(masks->d_tissueLabels.getValue(), std::vector<Label>{1, 2}));
  EXPECT_EQ(one->d_tetrahedra.getValueString(), masks->d_tetrahedra.getValueString());
}

TEST(ImageToTetrahedralMesh, BadInputsLeaveAMessageAndNothingElse) {
  const std::vector<std::pair<std::map<std::string, std::string>, std::string>> cases = {
      {{{"minDihedral", "50"}}, "minDihedral is 50"},
      {{{"fidelity", "0"}}, "fidelity"},
      {{{"fidelityLabel", "9=0.9"}}, "fidelityLabel: the image has no label 9; it has 1, 7"},
      {{{"fidelityLabel", "0.9"}}, "fidelityLabel: write it as LABEL=F"},
      {{{"labels", "9-3"}}, "labels: the range '9-3' runs backwards"},
      {{{"young", "1=soft"}}, "young: 'soft' is not a finite number"},
      {{{"tissue", "1=bone"}}, "tissue: 'bone' is not one of brain"},
      {{{"frame", "abc"}}, "frame: 'abc' is not one of lps|ras"},
      {{{"maxElements", "-4"}}, "maxElements is -4"},
      {{{"dimensions", "3 3 3"}}, "voxels"},
      {{{"spacing", "1 0 1"}}, "spacing"},
      {{{"filename", "/nowhere/image.nrrd"}}, "both filename and voxels"},
      {{{"voxels", ""}, {"filename", "/nowhere/image.nrrd"}}, "/nowhere/image.nrrd"},
      {{{"voxels", ""}}, "there is no image"}};
  for (const auto& [given, message] : cases) {
    const auto mesher = mesher_of(two_balls());
    mesher->init();
    EXPECT_TRUE(is_valid(*mesher));
    for (const auto& [data, text] : given) set(*mesher, data, text);
    EXPECT_TRUE(mesher->d_tetrahedra.getValue().empty()) << message;
    EXPECT_TRUE(mesher->d_position.getValue().empty()) << message;
    EXPECT_FALSE(is_valid(*mesher)) << message;
    EXPECT_NE(errors_of(*mesher).find(message), std::string::npos) << message << "\n" << errors_of(*mesher);
  }
}

TEST(ImageToTetrahedralMesh, RecoversFromABadInput) {
  const auto mesher = mesher_of(two_balls());
  set(*mesher, "minDihedral", "50");
  mesher->init();
  EXPECT_FALSE(is_valid(*mesher));
  set(*mesher, "minDihedral", "15");
  EXPECT_FALSE(mesher->d_tetrahedra.getValue().empty());
  EXPECT_TRUE(is_valid(*mesher));
}

TEST(ImageToTetrahedralMesh, CacheGivesTheSameMesh) {
  const TemporaryFolder folder;
  const auto cached = [&] {
    const auto mesher = mesher_of(two_balls());
    set(*mesher, "cacheDirectory", folder.path().string());
    mesher->init();
    EXPECT_TRUE(is_valid(*mesher)) << errors_of(*mesher);
    return mesher;
  };
  const auto first = cached();
  const auto file = cached_mesh(folder.path(), content_hash(two_balls(), {}));
  ASSERT_TRUE(std::filesystem::exists(file));
  const auto written = std::filesystem::last_write_time(file);
  const auto second = cached();
  const TetMesh mesh = image_to_mesh(two_balls()).mesh;
  expect_mesh(*first, mesh);
  expect_mesh(*second, mesh);
  EXPECT_EQ(first->d_triangles.getValueString(), second->d_triangles.getValueString());
  EXPECT_EQ(std::filesystem::last_write_time(file), written);

  std::ofstream(file) << "damaged";
  expect_mesh(*cached(), mesh);
  expect_mesh(*cached(), read_mesh(file));
}

TEST(ImageToTetrahedralMesh, HashTellsImagesAndOptionsApart) {
  std::set<std::string> hashes = {content_hash(two_balls(), {})};
  LabelImage moved = two_balls(), relabelled = two_balls();
  moved.origin_mm.x += 1e-9;
  relabelled.voxels[100] = 3;
  hashes.insert(content_hash(moved, {}));
  hashes.insert(content_hash(relabelled, {}));
  std::size_t unlike = hashes.size();
  for (const OptionCase& option : option_cases()) {
    const auto mesher = mesher_of(two_balls());
    set(*mesher, option.data, option.text);
    const bool bears_on_the_mesh = std::string(option.data) != "threads" && std::string(option.data) != "maxMemory";
    hashes.insert(content_hash(two_balls(), options_of(mesher->options.request())));
    unlike += bears_on_the_mesh;
  }
  EXPECT_EQ(hashes.size(), unlike);
}

}  // namespace
}  // namespace anatomesh::simulation
