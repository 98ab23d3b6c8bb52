#include "pipeline/guarantees.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "anatomesh/assess.h"
#include "base/vec.h"
#include "mesh/expect_sound.h"
#include "mesh/mesh_checks.h"

namespace anatomesh::testing {
namespace {

/// Physical space of the result -> voxel index of the image.
class ToIndex {
 public:
  ToIndex(const LabelImage& image, Frame frame) : image_(image), sign_(frame == Frame::lps ? 1 : -1) {}

  Vec3 operator()(Vec3 p) const {
    const Vec3 d = Vec3{sign_ * p.x, sign_ * p.y, p.z} - image_.origin_mm;
    Vec3 index;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t row = 0; row < 3; ++row) index[a] += image_.direction[row][a] * d[row];
      index[a] /= image_.spacing_mm[a];
    }
    return index;
  }

 private:
  const LabelImage& image_;
  double sign_;
};

bool contains(const LabelImage& image, const std::array<long, 3>& at) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (at[a] < 0 || at[a] >= static_cast<long>(image.size[a])) return false;
  }
  return true;
}

/// Whether a voxel of the label is the nearest one to the point, or touches that one.
bool is_near_label(const LabelImage& image, Vec3 index, Label label) {
  for (int n = 0; n < 27; ++n) {
    const std::array<long, 3> at = {std::lround(index.x) + n % 3 - 1, std::lround(index.y) + n / 3 % 3 - 1,
                                    std::lround(index.z) + n / 9 - 1};
    if (!contains(image, at)) continue;
    const auto [i, j, k] =
        std::array{static_cast<std::size_t>(at[0]), static_cast<std::size_t>(at[1]), static_cast<std::size_t>(at[2])};
    if (image.at(i, j, k) == label) return true;
  }
  return false;
}

/// Voxels of every label to be meshed.
std::map<Label, std::uint64_t> wanted_labels(const LabelImage& image, const Options& options) {
  std::map<Label, std::uint64_t> wanted;
  for (const Label label : image.voxels) {
    const auto& chosen = options.labels;
    const bool is_chosen = chosen.empty() || std::find(chosen.begin(), chosen.end(), label) != chosen.end();
    if (label != 0 && is_chosen) ++wanted[label];
  }
  return wanted;
}

Assessment assess_quickly(const Result& result, const LabelImage* image) {
  AssessOptions options;
  options.frame = result.options.frame;
  options.distances = false;
  return assess(result.mesh, image, options);
}

}  // namespace

std::size_t voxels_in_several_tets(const LabelImage& image, const Result& result) {
  const ToIndex to_index(image, result.options.frame);
  std::vector<std::uint8_t> holders(image.voxels.size(), 0);
  for (const Tet& tet : result.mesh.tets) {
    Corners corners = corners_of(result.mesh.points_mm, tet);
    for (Vec3& corner : corners) corner = to_index(corner);
    std::array<long, 3> low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [least, most] = std::minmax({corners[0][a], corners[1][a], corners[2][a], corners[3][a]});
      low[a] = std::max(0L, static_cast<long>(std::ceil(least)));
      high[a] = std::min(static_cast<long>(image.size[a]) - 1, static_cast<long>(std::floor(most)));
    }
    for (long k = low[2]; k <= high[2]; ++k) {
      for (long j = low[1]; j <= high[1]; ++j) {
        for (long i = low[0]; i <= high[0]; ++i) {
          const Vec3 centre = {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          const auto offset =
              static_cast<std::size_t>(i) +
              image.size[0] * (static_cast<std::size_t>(j) + image.size[1] * static_cast<std::size_t>(k));
          if (holders[offset] < 2 && depth_inside(corners, centre) > 1e-9) ++holders[offset];
        }
      }
    }
  }
  return static_cast<std::size_t>(std::count(holders.begin(), holders.end(), 2));
}

void expect_valid(const LabelImage& image, const Result& result) {
  const std::vector<Vec3>& points = result.mesh.points_mm;
  const auto& tets = result.mesh.tets;
  ASSERT_FALSE(tets.empty());
  ASSERT_EQ(result.mesh.labels.size(), tets.size());
  EXPECT_GT(smallest_volume(points, tets), 0);
  EXPECT_EQ(crowded_faces(points, tets), 0u);
  EXPECT_EQ(vertices_inside_outer_faces(points, tets), 0u);
  EXPECT_EQ(duplicate_vertices(points), 0u);
  EXPECT_EQ(unused_vertices(points.size(), tets), 0u);
  EXPECT_EQ(voxels_in_several_tets(image, result), 0u);
}

void expect_bounded(const Result& result) {
  constexpr double kRoundingDeg = 1e-9;
  const DeformOptions& bounds = result.options.deform;
  const bool lattice = bounds.iterations == 0;
  expect_within(worst_shape(result.mesh.points_mm, result.mesh.tets),
                (lattice ? 30 : bounds.min_dihedral_deg) - kRoundingDeg,
                (lattice ? 116.57 : bounds.max_dihedral_deg) + kRoundingDeg, lattice ? 0.58 : bounds.min_mean_ratio);
}

void expect_complete(const LabelImage& image, const Result& result) {
  std::map<Label, std::uint64_t> voxels, tets;
  for (const Label label : result.mesh.labels) ++tets[label];
  for (const TissueOutcome& tissue : result.tissues) {
    EXPECT_TRUE(voxels.try_emplace(tissue.label, tissue.voxels).second) << "named twice: " << tissue.label;
    EXPECT_EQ(tissue.tets, tets[tissue.label]) << tissue.label;
    EXPECT_GT(tissue.tets, 0u) << "not in the mesh: " << tissue.label;
    EXPECT_GE(tissue.lattice_f1, 0);
    EXPECT_LE(tissue.lattice_f1, 1);
    EXPECT_LE(tissue.lattice_f2, 1);
  }
  EXPECT_EQ(voxels, wanted_labels(image, result.options));
  EXPECT_EQ(tets.size(), voxels.size());
  for (const std::string& warning : result.warnings)
    EXPECT_EQ(warning.find("is not in the mesh"), std::string::npos) << warning;
}

void expect_in_place(const LabelImage& image, const Result& result) {
  const ToIndex to_index(image, result.options.frame);
  std::map<Label, double> volume, near;
  for (std::size_t t = 0; t < result.mesh.tets.size(); ++t) {
    const Corners corners = corners_of(result.mesh.points_mm, result.mesh.tets[t]);
    const double tet_volume = shape_of(corners).volume;
    const Vec3 centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const Label label = result.mesh.labels[t];
    volume[label] += tet_volume;
    if (is_near_label(image, to_index(centre), label)) near[label] += tet_volume;
  }
  for (const auto& [label, total] : volume) EXPECT_GE(near[label], 0.95 * total) << "label " << label;
}

void expect_fidelity_as_measured(const LabelImage& image, const Result& result) {
  constexpr double kOnFaces = 1e-3;  // centres on faces, decided in another frame
  const Assessment assessment = assess_quickly(result, &image);
  for (const TissueOutcome& tissue : result.tissues) {
    const auto measured = std::ranges::find(assessment.tissues, tissue.label, &TissueAssessment::label);
    ASSERT_NE(measured, assessment.tissues.end()) << tissue.label;
    EXPECT_NEAR(tissue.f1, measured->fidelity.f1, kOnFaces) << "label " << tissue.label;
    EXPECT_NEAR(tissue.f2, measured->fidelity.f2, kOnFaces) << "label " << tissue.label;
  }
}

void expect_faithful(const Result& result) {
  for (const TissueOutcome& tissue : result.tissues) {
    EXPECT_GE(tissue.f1, tissue.fidelity) << "label " << tissue.label;
    EXPECT_GE(tissue.f2, tissue.fidelity) << "label " << tissue.label;
  }
}

void expect_manifold(const Result& result) {
  for (const TissueAssessment& tissue : assess_quickly(result, nullptr).tissues) {
    EXPECT_EQ(tissue.topology.nonmanifold_edges, 0u) << "label " << tissue.label;
    EXPECT_EQ(tissue.topology.nonmanifold_vertices, 0u) << "label " << tissue.label;
  }
}

void expect_components(const LabelImage& image, const Result& result) {
  constexpr std::uint64_t kFewVoxels = 50;
  for (const TissueAssessment& tissue : assess_quickly(result, &image).tissues) {
    if (!tissue.in_mesh || tissue.fidelity.image_voxels <= kFewVoxels) continue;
    EXPECT_EQ(tissue.topology.tet_components, tissue.topology.image_components_26) << "label " << tissue.label;
  }
}

void expect_guarantees(const LabelImage& image, const Result& result) {
  expect_valid(image, result);
  expect_bounded(result);
  expect_complete(image, result);
  expect_in_place(image, result);
  expect_fidelity_as_measured(image, result);
  expect_manifold(result);
  expect_components(image, result);
}

}  // namespace anatomesh::testing
