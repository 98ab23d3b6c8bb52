#include <array>
#include <cmath>
#include <vector>

#include "anatomesh/assess.h"
#include "assess/tet_measures.h"
#include "base/parallel.h"

namespace anatomesh {

ShapeSummary summarise_shapes(const TetMesh& mesh) {
  constexpr std::size_t kGrain = 16384;
  std::vector<ShapeSummary> blocks((mesh.tets.size() + kGrain - 1) / kGrain);  // with sums in place of means
  parallel_blocks(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    ShapeSummary block;
    block.mean_mean_ratio = 0;
    for (std::size_t t = begin; t < end; ++t) {
      std::array<Vec3, 4> corners;
      for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.points_mm[mesh.tets[t][k]];
      const assess_detail::TetMeasures m = assess_detail::measure_tet(corners);
      // std::fmin and std::fmax pass over the NaN that stands for "none yet".
      block.min_dihedral_deg = std::fmin(block.min_dihedral_deg, m.min_dihedral_deg);
      block.max_dihedral_deg = std::fmax(block.max_dihedral_deg, m.max_dihedral_deg);
      block.min_mean_ratio = std::fmin(block.min_mean_ratio, m.mean_ratio);
      block.mean_mean_ratio += m.mean_ratio;
    }
    blocks[begin / kGrain] = block;
  });
  ShapeSummary all;
  double sum = 0;
  for (const ShapeSummary& block : blocks) {
    all.min_dihedral_deg = std::fmin(all.min_dihedral_deg, block.min_dihedral_deg);
    all.max_dihedral_deg = std::fmax(all.max_dihedral_deg, block.max_dihedral_deg);
    all.min_mean_ratio = std::fmin(all.min_mean_ratio, block.min_mean_ratio);
    sum += block.mean_mean_ratio;
  }
  if (!mesh.tets.empty()) all.mean_mean_ratio = sum / static_cast<double>(mesh.tets.size());
  return all;
}

}  // namespace anatomesh
