#include <gtest/gtest.h>

#include <algorithm>

#include "anatomesh/io.h"
#include "support/shared_data.h"

namespace anatomesh::testing {
namespace {

double determinant(const Mat3& m) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += m[0][c] * (m[1][(c + 1) % 3] * m[2][(c + 2) % 3] - m[1][(c + 2) % 3] * m[2][(c + 1) % 3]);
  }
  return sum;
}

/// What a real image must read as.
struct Expected {
  const char* file;
  std::array<std::size_t, 3> size;
  Vec3 spacing_mm;
  std::size_t labels;
  Label largest;
  bool is_left_handed;
  bool forms_disagree;
};

std::ostream& operator<<(std::ostream& out, const Expected& expected) { return out << expected.file; }

class SharedImage : public ::testing::TestWithParam<Expected> {};

TEST_P(SharedImage, ReadsAsDescribed) {
  const Expected expected = GetParam();
  const auto path = find_image(expected.file);
  if (path.empty()) GTEST_SKIP() << expected.file << " is not on this machine";
  const ImageFile file = read_label_image(path);
  EXPECT_EQ(file.image.size, expected.size);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(file.image.spacing_mm[axis], expected.spacing_mm[axis], 1e-6);
  }
  EXPECT_NEAR(determinant(file.image.direction), expected.is_left_handed ? -1 : 1, 1e-12);
  EXPECT_EQ(file.notes.size(), expected.forms_disagree ? 1U : 0U);
  std::vector<Label> labels = file.image.voxels;
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());  // runs first: it is a long list
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  EXPECT_EQ(labels.size() - (labels.front() == 0 ? 1 : 0), expected.labels);
  EXPECT_EQ(labels.back(), expected.largest);
}

INSTANTIATE_TEST_SUITE_P(
    RealImages, SharedImage,
    ::testing::Values(
        Expected{"crtc_i2m_ventricles.nii.gz", {240, 240, 134}, {1, 1, 1}, 1, 128, false, false},
        Expected{"crtc_i2m_nidus.nii.gz", {256, 256, 165}, {0.859375, 0.859375, 0.729167}, 1, 1, false, false},
        Expected{"spl_brain_hncma_atlas.nrrd", {256, 256, 256}, {1, 1, 1}, 312, 4100, true, false},
        Expected{"spl_knee_seg.nrrd", {512, 512, 119}, {0.2773402, 0.2773402, 1}, 49, 98, true, false},
        Expected{"medmpd_p3_brain_ventricles_1mm_LIA.nii.gz", {143, 160, 175}, {1, 1, 1}, 2, 2, true, true},
        Expected{"fvb_mouse_exvivo_oblique.nii.gz", {442, 286, 214}, {0.04, 0.04, 0.04}, 37, 40, true, false},
        Expected{"gubra_mouse_brain_large_uint32.nii.gz", {461, 621, 323}, {1, 1, 1}, 321, 614454277, false, false},
        Expected{"cleaver_mickey.nrrd", {63, 63, 63}, {1, 1, 1}, 5, 5, false, false},
        Expected{"aal.nii.gz", {181, 217, 181}, {1, 1, 1}, 116, 116, false, false},
        Expected{"jhu189.nii.gz", {157, 189, 136}, {1, 1, 1}, 189, 189, true, true},
        Expected{"natbrainlab.nii.gz", {157, 189, 136}, {1, 1, 1}, 32, 116, true, true},
        Expected{"inia19-NeuroMaps.nii.gz", {168, 206, 128}, {0.5, 0.5, 0.5}, 724, 1605, false, true}));

}  // namespace
}  // namespace anatomesh::testing
