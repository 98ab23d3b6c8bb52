// The guarantees on real segmented images, as far as this machine has them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <set>
#include <string>

#include "anatomesh/assess.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/io.h"
#include "support/shared_data.h"

namespace anatomesh {
namespace {

/// An image, and the lattice spacing to mesh it with as a multiple of the mean voxel spacing.
struct RealImage {
  const char* file;
  double bcc_size_vox = 8;
  bool takes_minutes = false;  ///< meshed only when ANATOMESH_LARGE_IMAGES is set; tools/check_images.py runs all
};

constexpr std::array<RealImage, 24> kImages = {{{"allen_human_2020.nii.gz", 40, true},
                                                {"brats2013_p1_brain_tumor.nii.gz", 24},
                                                {"cleaver_mickey.nrrd"},
                                                {"crtc_i2m_brain.nii.gz"},
                                                {"crtc_i2m_nidus.nii.gz"},
                                                {"crtc_i2m_ventricles.nii.gz"},
                                                {"fvb_mouse_exvivo_oblique.nii.gz", 32, true},
                                                {"gubra_mouse_brain_large_uint32.nii.gz", 64, true},
                                                {"medmpd_p2_intracranial_ventricles_vessels.nii.gz", 32, true},
                                                {"medmpd_p3_brain_ventricles_1mm_LIA.nii.gz"},
                                                {"niivue_torsoLabel.nii.gz"},
                                                {"seg3d_brain_skull.nii.gz", 24, true},
                                                {"spl_brain_hncma_atlas.nrrd", 32, true},
                                                {"spl_knee_seg.nrrd", 32, true},
                                                {"totalseg_example_seg.nii.gz", 16},
                                                {"aal.nii.gz", 24, true},
                                                {"brodmann.nii.gz", 24, true},
                                                {"HarvardOxford-cort-maxprob-thr0-1mm.nii.gz", 24, true},
                                                {"JHU-WhiteMatter-labels-1mm.nii.gz", 24},
                                                {"JHU-WhiteMatter-labels-2mm.nii.gz", 16},
                                                {"natbrainlab.nii.gz", 24, true},
                                                {"jhu189.nii.gz", 24, true},
                                                {"inia19-NeuroMaps.nii.gz", 32, true},
                                                {"AICHAmc.nii.gz", 24, true}}};

std::string name_of(const ::testing::TestParamInfo<RealImage>& info) {
  std::string name = info.param.file;
  name = name.substr(0, name.find('.'));
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

class RealImages : public ::testing::TestWithParam<RealImage> {};

INSTANTIATE_TEST_SUITE_P(All, RealImages, ::testing::ValuesIn(kImages), name_of);

Options options_for(const LabelImage& image, double bcc_size_vox) {
  const Vec3 s = image.spacing_mm;
  Options options;
  options.lattice.bcc_size_mm = bcc_size_vox * (s.x + s.y + s.z) / 3;
  return options;
}

void expect_whole_surfaces(const Assessment& assessment) {
  constexpr std::uint64_t kFewVoxels = 50;
  EXPECT_EQ(assessment.summary.nonmanifold_edges, 0u);
  EXPECT_EQ(assessment.summary.nonmanifold_vertices, 0u);
  for (const TissueAssessment& tissue : assessment.tissues) {
    if (tissue.fidelity.image_voxels <= kFewVoxels) continue;
    EXPECT_EQ(tissue.topology.tet_components, tissue.topology.image_components_26) << "label " << tissue.label;
  }
}

void expect_fidelity_as_measured(const Result& result, const Assessment& assessment) {
  for (const TissueOutcome& tissue : result.tissues) {
    const auto measured = std::ranges::find(assessment.tissues, tissue.label, &TissueAssessment::label);
    ASSERT_NE(measured, assessment.tissues.end()) << tissue.label;
    EXPECT_NEAR(tissue.f1, measured->fidelity.f1, 1e-3) << "label " << tissue.label;
    EXPECT_NEAR(tissue.f2, measured->fidelity.f2, 1e-3) << "label " << tissue.label;
  }
}

TEST_P(RealImages, KeepTheGuarantees) {
  const auto path = testing::find_image(GetParam().file);
  if (path.empty()) GTEST_SKIP() << GetParam().file << " is not on this machine";
  if (GetParam().takes_minutes && std::getenv("ANATOMESH_LARGE_IMAGES") == nullptr)
    GTEST_SKIP() << GetParam().file << " takes minutes; set ANATOMESH_LARGE_IMAGES to mesh it";
  const LabelImage image = read_label_image(path).image;
  const Result result = image_to_mesh(image, options_for(image, GetParam().bcc_size_vox));
  double seconds = 0;
  for (const StageTime& time : result.times) seconds += time.seconds;
  AssessOptions options;
  options.distances = false;
  const Assessment assessment = assess(result.mesh, &image, options);
  std::cout << GetParam().file << ": " << result.mesh.tets.size() << " tetrahedra in " << seconds << " s, Dice "
            << assessment.whole.fidelity.dice << ", " << assessment.summary.labels_in_mesh << " labels\n";

  for (const std::string& failure : failed_guarantees(assessment, options)) ADD_FAILURE() << failure;
  expect_whole_surfaces(assessment);
  expect_fidelity_as_measured(result, assessment);
  std::set<Label> in_image(image.voxels.begin(), image.voxels.end());
  in_image.erase(0);
  EXPECT_EQ(std::set<Label>(result.mesh.labels.begin(), result.mesh.labels.end()), in_image);
  EXPECT_GE(assessment.whole.fidelity.dice, 0.90);
}

TEST(RealImagesTable, NamesAllThereAre) {
  std::set<std::string> in_table;
  for (const RealImage& image : kImages) in_table.insert(image.file);
  for (const auto& images : {testing::shared_images(), testing::mricron_images()}) {
    for (const auto& path : images) EXPECT_TRUE(in_table.contains(path.filename())) << path.filename();
  }
}

}  // namespace
}  // namespace anatomesh
