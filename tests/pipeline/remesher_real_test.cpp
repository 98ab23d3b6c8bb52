// Updates of the meshes of real segmented images, as far as this machine has them.
#include <gtest/gtest.h>

#include <iostream>
#include <string>

#include "anatomesh/assess.h"
#include "anatomesh/io.h"
#include "anatomesh/remesher.h"
#include "support/shared_data.h"

namespace anatomesh {
namespace {

/// Gives the tissues' voxels in a ball a label.
void paint(LabelImage& image, std::size_t middle, double radius_mm, Label label) {
  const std::size_t nx = image.size[0], ny = image.size[1];
  const auto away = [](std::size_t a, std::size_t b, double mm) {
    return (static_cast<double>(a) - static_cast<double>(b)) * mm;
  };
  for (std::size_t v = 0; v < image.voxels.size(); ++v) {
    const double x = away(v % nx, middle % nx, image.spacing_mm.x);
    const double y = away(v / nx % ny, middle / nx % ny, image.spacing_mm.y);
    const double z = away(v / nx / ny, middle / nx / ny, image.spacing_mm.z);
    if (image.voxels[v] != 0 && x * x + y * y + z * z <= radius_mm * radius_mm) image.voxels[v] = label;
  }
}

/// The labelled voxel with this share of them before it.
std::size_t labelled_voxel(const LabelImage& image, double share) {
  std::size_t count = 0;
  for (const Label label : image.voxels) count += label != 0;
  auto left = static_cast<std::size_t>(share * static_cast<double>(count));
  std::size_t v = 0;
  while (image.voxels[v] == 0 || left-- > 0) ++v;
  return v;
}

void expect_guarantees(const LabelImage& image, const Result& result) {
  AssessOptions options;
  options.distances = false;
  const Assessment assessment = assess(result.mesh, &image, options);
  for (const std::string& failure : failed_guarantees(assessment, options)) ADD_FAILURE() << failure;
  EXPECT_EQ(assessment.summary.nonmanifold_edges, 0u);
  EXPECT_EQ(assessment.summary.nonmanifold_vertices, 0u);
  for (const TissueAssessment& tissue : assessment.tissues) {
    if (tissue.fidelity.image_voxels <= 50) continue;
    EXPECT_EQ(tissue.topology.tet_components, tissue.topology.image_components_26) << "label " << tissue.label;
  }
}

class RemesherOnRealImages : public ::testing::TestWithParam<const char*> {};

TEST_P(RemesherOnRealImages, KeepsTheGuarantees) {
  const auto path = testing::find_image(GetParam());
  if (path.empty()) GTEST_SKIP() << GetParam() << " is not on this machine";
  LabelImage image = read_label_image(path).image;
  Remesher mesher(image);
  for (const double share : {0.3, 0.5, 0.8}) {
    SCOPED_TRACE("at " + std::to_string(share));
    paint(image, labelled_voxel(image, share), 7, share == 0.5 ? 4000 : 0);
    const UpdateReport report = mesher.update(image);
    std::cout << GetParam() << ": " << report.changed_voxels << " voxels, " << report.new_tets << " new tetrahedra, "
              << (report.whole ? report.reason : "local") << "\n";
    expect_guarantees(image, mesher.result());
  }
}

INSTANTIATE_TEST_SUITE_P(Some, RemesherOnRealImages,
                         ::testing::Values("crtc_i2m_ventricles.nii.gz", "totalseg_example_seg.nii.gz"));

}  // namespace
}  // namespace anatomesh
