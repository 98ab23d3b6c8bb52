#include "assess/quality.h"

#include <algorithm>
#include <cmath>

#include "assess/statistics.h"
#include "base/parallel.h"

namespace anatomesh::assess_detail {
namespace {

/// What one pass over some tetrahedra adds up.
struct Tally {
  Quality quality;
  double mean_ratio = 0, scaled_jacobian = 0;  // sums
  std::uint64_t below_5 = 0, below_10 = 0, below_15 = 0, above_165 = 0;

  void add(const TetMeasures& m) {
    Quality& q = quality;
    // std::fmin and std::fmax pass over the NaN that stands for "none yet".
    q.min_dihedral_deg = std::fmin(q.min_dihedral_deg, m.min_dihedral_deg);
    q.max_dihedral_deg = std::fmax(q.max_dihedral_deg, m.max_dihedral_deg);
    q.min_mean_ratio = std::fmin(q.min_mean_ratio, m.mean_ratio);
    q.min_scaled_jacobian = std::fmin(q.min_scaled_jacobian, m.scaled_jacobian);
    q.min_edge_mm = std::fmin(q.min_edge_mm, m.min_edge_mm);
    q.max_edge_mm = std::fmax(q.max_edge_mm, m.max_edge_mm);
    q.max_edge_ratio = std::fmax(q.max_edge_ratio, m.max_edge_mm / m.min_edge_mm);
    q.volume_mm3 += m.volume_mm3;
    q.inverted += m.inverted();
    q.degenerate += m.degenerate();
    for (const std::uint8_t bin : m.dihedral_bin) ++q.dihedral_histogram[bin];
    mean_ratio += m.mean_ratio;
    scaled_jacobian += m.scaled_jacobian;
    below_5 += m.min_dihedral_deg < 5;
    below_10 += m.min_dihedral_deg < 10;
    below_15 += m.min_dihedral_deg < 15;
    above_165 += m.max_dihedral_deg > 165;
  }

  void add(const Tally& o) {
    Quality& q = quality;
    q.min_dihedral_deg = std::fmin(q.min_dihedral_deg, o.quality.min_dihedral_deg);
    q.max_dihedral_deg = std::fmax(q.max_dihedral_deg, o.quality.max_dihedral_deg);
    q.min_mean_ratio = std::fmin(q.min_mean_ratio, o.quality.min_mean_ratio);
    q.min_scaled_jacobian = std::fmin(q.min_scaled_jacobian, o.quality.min_scaled_jacobian);
    q.min_edge_mm = std::fmin(q.min_edge_mm, o.quality.min_edge_mm);
    q.max_edge_mm = std::fmax(q.max_edge_mm, o.quality.max_edge_mm);
    q.max_edge_ratio = std::fmax(q.max_edge_ratio, o.quality.max_edge_ratio);
    q.volume_mm3 += o.quality.volume_mm3;
    q.inverted += o.quality.inverted;
    q.degenerate += o.quality.degenerate;
    for (std::size_t b = 0; b < Quality::kDihedralBins; ++b) q.dihedral_histogram[b] += o.quality.dihedral_histogram[b];
    mean_ratio += o.mean_ratio;
    scaled_jacobian += o.scaled_jacobian;
    below_5 += o.below_5;
    below_10 += o.below_10;
    below_15 += o.below_15;
    above_165 += o.above_165;
  }
};

Tally tally(std::span<const TetId> tets, const std::vector<TetMeasures>& measures) {
  constexpr std::size_t kGrain = 16384;
  std::vector<Tally> blocks((tets.size() + kGrain - 1) / kGrain);
  parallel_blocks(tets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Tally block;
    for (std::size_t i = begin; i < end; ++i) block.add(measures[tets[i]]);
    blocks[begin / kGrain] = block;
  });
  Tally all;
  for (const Tally& block : blocks) all.add(block);
  return all;
}

void set_percentiles(std::span<const TetId> tets, const std::vector<TetMeasures>& measures, Quality& quality) {
  std::vector<double> smallest(tets.size());
  parallel_for(tets.size(), [&](std::size_t i) { smallest[i] = measures[tets[i]].min_dihedral_deg; });
  quality.dihedral_p0_1_deg = percentile(smallest, 0.1);
  quality.dihedral_p1_deg = percentile(smallest, 1);
  quality.dihedral_p5_deg = percentile(smallest, 5);
  quality.dihedral_median_deg = percentile(smallest, 50);
}

void set_gradation(std::span<const TetId> tets, Scope scope, const TissueMesh& mesh,
                   const std::vector<TetMeasures>& measures, const Neighbours& neighbours, Quality& quality) {
  std::vector<double> ratios;
  for (const TetId t : tets) {
    for (const TetId u : neighbours.across[t]) {
      if (u >= kCrowded || u < t || (scope == Scope::tissue && mesh.tissue_of[u] != mesh.tissue_of[t])) continue;
      const auto [small, large] = std::minmax({std::abs(measures[t].volume_mm3), std::abs(measures[u].volume_mm3)});
      ratios.push_back(large / std::max(small, 1e-300));
    }
  }
  quality.gradation_p99 = ratios.empty() ? 1 : percentile(ratios, 99);
  quality.max_gradation = ratios.empty() ? 1 : *std::max_element(ratios.begin(), ratios.end());
}

}  // namespace

Quality quality_of(std::span<const TetId> tets, Scope scope, const TissueMesh& mesh,
                   const std::vector<TetMeasures>& measures, const Neighbours& neighbours, const Skeleton& skeleton) {
  if (tets.empty()) return {};
  const Tally sums = tally(tets, measures);
  const auto count = static_cast<double>(tets.size());
  const auto share = [&](std::uint64_t part) { return static_cast<double>(part) / count; };
  Quality quality = sums.quality;
  quality.tets = tets.size();
  quality.vertices = skeleton.vertices;
  quality.edges = skeleton.edges;
  quality.share_below_5_deg = share(sums.below_5);
  quality.share_below_10_deg = share(sums.below_10);
  quality.share_below_15_deg = share(sums.below_15);
  quality.share_above_165_deg = share(sums.above_165);
  quality.mean_mean_ratio = sums.mean_ratio / count;
  quality.mean_scaled_jacobian = sums.scaled_jacobian / count;
  quality.mean_edge_mm = skeleton.edge_length_mm / static_cast<double>(skeleton.edges);
  set_percentiles(tets, measures, quality);
  set_gradation(tets, scope, mesh, measures, neighbours, quality);
  return quality;
}

}  // namespace anatomesh::assess_detail
