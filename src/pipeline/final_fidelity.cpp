#include "pipeline/final_fidelity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/voxel_owners.h"

namespace anatomesh {
namespace {

// Not every wrong voxel in a refined tetrahedron becomes right, but its neighbours gain as well. Asking for a little
// more than F saves rounds at the end.
constexpr double kMargin = 0.08;  // of what may be wrong

std::vector<Vec3> in_voxels(const std::vector<Vec3>& points_mm, const TissueImage& image) {
  std::vector<Vec3> points(points_mm.size());
  parallel_for(points.size(), [&](std::size_t v) {
    for (std::size_t a = 0; a < 3; ++a)
      points[v][a] = points_mm[v][a] / image.spacing_mm[a] - static_cast<double>(image.first[a]);
  });
  return points;
}

bool is_inside(const TissueImage& image, std::size_t voxel) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [begin, end] = image.inside(a);
    const auto size = static_cast<std::size_t>(image.size[a]);
    const auto index = static_cast<int>(voxel % size);
    if (index < begin || index >= end) return false;
    voxel /= size;
  }
  return true;
}

}  // namespace

MeshFidelity measure_fidelity(const TissueMesh& mesh, const TissueImage& image, const Stage& stage) {
  GridSize size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<std::size_t>(image.size[a]);
  const std::size_t tissue_count = image.labels.size();
  MeshFidelity result;
  result.tissue_in_mesh.resize(image.voxels.size());
  std::vector<std::vector<Fidelity>> parts((size[2] + OwnedSlices::kMost - 1) / OwnedSlices::kMost);
  const std::vector<Vec3> points = in_voxels(mesh.points_mm, image);
  for_each_owned_slices(points, mesh.tets, size, stage.cancel_token(), [&](const OwnedSlices& slices) {
    auto& counts = parts[slices.first / OwnedSlices::kMost];
    counts.resize(2 * tissue_count);
    const std::size_t begin = slices.first * size[0] * size[1];
    for (std::size_t v = 0; v < slices.owner.size(); ++v) {
      const TissueId in_mesh = slices.owner[v] == kNoTet ? TissueId{0} : mesh.tissues[slices.owner[v]];
      result.tissue_in_mesh[begin + v] = in_mesh;
      ++counts[in_mesh].in_tets;
      counts[in_mesh].hits += in_mesh == image.voxels[begin + v];
      // Tissues have no voxels outside, so hits are the same.
      counts[tissue_count + in_mesh].in_tets += is_inside(image, begin + v);
    }
  });
  result.tissues.resize(tissue_count);
  result.inside.resize(tissue_count);
  for (const auto& part : parts) {
    for (std::size_t t = 0; t < tissue_count; ++t) {
      result.tissues[t].in_tets += part[t].in_tets;
      result.tissues[t].hits += part[t].hits;
      result.inside[t].in_tets += part[tissue_count + t].in_tets;
    }
  }
  for (std::size_t t = 0; t < tissue_count; ++t) {
    result.tissues[t].voxels = result.inside[t].voxels = image.counts[t];
    result.inside[t].hits = result.tissues[t].hits;
  }
  return result;
}

FarVoxels find_far_voxels(const MeshFidelity& reached, const TissueImage& image, const std::vector<char>& judged) {
  const std::vector<TissueId>& in_mesh = reached.tissue_in_mesh;
  const Vec3 s = image.spacing_mm;
  const double far_mm = std::max({s.x, s.y, s.z});
  std::array<int, 3> reach;
  std::array<std::size_t, 3> step = {1, 1, 1};
  for (std::size_t a = 0; a < 3; ++a) reach[a] = static_cast<int>(std::lround(far_mm / s[a]));
  for (std::size_t a = 1; a < 3; ++a) step[a] = step[a - 1] * static_cast<std::size_t>(image.size[a - 1]);
  const auto is_far = [&](std::array<int, 3> at) {
    const std::size_t v = image.offset(at[0], at[1], at[2]);
    const TissueId got = in_mesh[v], asked = image.voxels[v];
    if (got == asked || !(judged[asked] || judged[got])) return false;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [begin, end] = image.inside(a);
      if (at[a] - reach[a] < begin || at[a] + reach[a] >= end) return false;
      const std::size_t away = step[a] * static_cast<std::size_t>(reach[a]);
      if (in_mesh[v - away] != got || in_mesh[v + away] != got) return false;
    }
    return true;
  };
  std::vector<std::vector<std::uint32_t>> found(static_cast<std::size_t>(image.size[2]));
  parallel_for(
      found.size(),
      [&](std::size_t slice) {
        const auto k = static_cast<int>(slice);
        for (int j = 0; j < image.size[1]; ++j) {
          for (int i = 0; i < image.size[0]; ++i) {
            if (is_far({i, j, k})) found[slice].push_back(static_cast<std::uint32_t>(image.offset(i, j, k)));
          }
        }
      },
      1);
  FarVoxels far;
  far.of_tissue.assign(image.labels.size(), 0);
  far.others = reached.tissues;
  for (const auto& part : found) {
    far.voxels.insert(far.voxels.end(), part.begin(), part.end());
    for (const std::uint32_t v : part) {
      const TissueId asked = image.voxels[v], got = in_mesh[v];
      ++far.of_tissue[asked];
      ++far.of_tissue[got];
      --far.others[asked].voxels;
      --far.others[got].in_tets;
    }
  }
  return far;
}

FidelityGap find_gap(MeshFidelity& reached, const TissueImage& image, std::span<const double> wanted) {
  FidelityGap gap;
  gap.to_mend.assign(image.labels.size(), 0);
  std::vector<char> lacks(image.labels.size(), 0), exceeds(image.labels.size(), 0);
  for (std::size_t t = 1; t < image.labels.size(); ++t) {
    const Fidelity& f = reached.tissues[t];
    const auto hits = static_cast<double>(f.hits);
    const double asked = wanted[t] + kMargin * (1 - wanted[t]);
    lacks[t] = f.f2() < wanted[t];
    exceeds[t] = f.f1() < wanted[t];
    double wrong = 0;
    if (lacks[t]) wrong += asked * static_cast<double>(f.voxels) - hits;
    if (exceeds[t]) wrong += static_cast<double>(f.in_tets) - hits / asked;
    gap.to_mend[t] = static_cast<std::uint64_t>(std::ceil(wrong));
  }
  gap.wrong = std::move(reached.tissue_in_mesh);
  parallel_for(
      gap.wrong.size(),
      [&](std::size_t v) {
        const TissueId asked = image.voxels[v], got = gap.wrong[v];
        gap.wrong[v] = asked == got ? TissueId{0} : lacks[asked] ? asked : exceeds[got] ? got : TissueId{0};
      },
      1 << 16);
  return gap;
}

}  // namespace anatomesh
