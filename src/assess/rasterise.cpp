#include "assess/rasterise.h"

#include <algorithm>

#include "mesh/voxel_owners.h"

namespace anatomesh::assess_detail {
namespace {

/// Compares a few slices with the image.
Coverage compare(const OwnedSlices& slices, const TissueMesh& mesh, const LabelImage& image) {
  Coverage c;
  c.tissues.resize(mesh.labels.size());
  LabelLookup tissue_of(mesh.labels);
  const std::size_t nx = image.size[0], ny = image.size[1];
  const Label* voxels = image.voxels.data() + nx * ny * slices.first;
  const std::size_t end = slices.first + slices.owner.size() / (nx * ny);
  std::size_t v = 0;
  for (std::size_t k = slices.first; k < end; ++k) {
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i, ++v) {
        const bool owned = slices.owner[v] != kNoTet;
        const Tissue owner = owned ? mesh.tissue_of[slices.owner[v]] : 0;
        c.in_several += slices.holders[v] > 1;
        if (owned) ++c.tissues[owner].mesh;
        if (voxels[v] == 0) continue;
        const Tissue t = tissue_of(voxels[v]);
        VoxelCounts& counts = c.tissues[t];
        ++counts.image;
        counts.common += owned && owner == t;
        c.whole.common += owned;
        const std::array<std::int64_t, 3> at = {static_cast<std::int64_t>(i), static_cast<std::int64_t>(j),
                                                static_cast<std::int64_t>(k)};
        counts.range.include({at, at});
      }
    }
  }
  return c;
}

void add(Coverage& to, const Coverage& from) {
  for (std::size_t t = 0; t < to.tissues.size(); ++t) {
    to.tissues[t].image += from.tissues[t].image;
    to.tissues[t].mesh += from.tissues[t].mesh;
    to.tissues[t].common += from.tissues[t].common;
    to.tissues[t].range.include(from.tissues[t].range);
  }
  to.whole.common += from.whole.common;
  to.in_several += from.in_several;
}

}  // namespace

void VoxelRange::include(const VoxelRange& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

Coverage rasterise(const TissueMesh& mesh, const std::vector<Vec3>& points_vox, const LabelImage& image,
                   const std::stop_token& cancel) {
  std::vector<Coverage> parts((image.size[2] + OwnedSlices::kMost - 1) / OwnedSlices::kMost);
  for_each_owned_slices(points_vox, mesh.tets, image.size, cancel, [&](const OwnedSlices& slices) {
    parts[slices.first / OwnedSlices::kMost] = compare(slices, mesh, image);
  });
  Coverage sum;
  sum.tissues.resize(mesh.tissue_count());
  for (const Coverage& part : parts) add(sum, part);
  for (const VoxelCounts& t : sum.tissues) {
    sum.whole.image += t.image;
    sum.whole.mesh += t.mesh;
    sum.whole.range.include(t.range);
    sum.right += t.common;
  }
  return sum;
}

}  // namespace anatomesh::assess_detail
