#include "pipeline/outcome.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "anatomesh/quadratic.h"
#include "base/rotation.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Image frame (index * spacing) -> LPS or RAS.
struct ToPhysical {
  Mat3 rotation;
  Vec3 origin_mm;

  ToPhysical(const LabelImage& image, Frame frame)
      : rotation(nearest_orthonormal(image.direction)), origin_mm(image.origin_mm) {
    if (frame == Frame::lps) return;
    for (const std::size_t axis : {0u, 1u}) {
      for (double& entry : rotation[axis]) entry = -entry;
      origin_mm[axis] = -origin_mm[axis];
    }
  }
  Vec3 operator()(Vec3 p) const { return origin_mm + rotation * p; }
  bool mirrors() const { return determinant(rotation) < 0; }
};

TetMesh in_physical_space(const TissueMesh& mesh, const TissueImage& tissues, const LabelImage& image, Frame frame) {
  const ToPhysical to_physical(image, frame);
  constexpr VertexId kUnused = static_cast<VertexId>(-1);
  TetMesh result;
  std::vector<VertexId> number(mesh.points_mm.size(), kUnused);
  const bool mirrors = to_physical.mirrors();
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.tissues[t] == 0) continue;
    std::array<VertexId, 4> tet = mesh.tets[t];
    if (mirrors) std::swap(tet[2], tet[3]);
    for (VertexId& v : tet) {
      if (number[v] == kUnused) {
        number[v] = static_cast<VertexId>(result.points_mm.size());
        result.points_mm.push_back(to_physical(mesh.points_mm[v]));
      }
      v = number[v];
    }
    result.tets.push_back(tet);
    result.labels.push_back(tissues.labels[mesh.tissues[t]]);
  }
  for (const Label label : tissues.labels) {
    const auto entry = image.names.find(label);
    if (label != 0 && entry != image.names.end()) result.names.insert(*entry);
  }
  return result;
}

}  // namespace

TetMesh finished_mesh(const TissueMesh& mesh, const TissueImage& tissues, const LabelImage& image,
                      const Options& options) {
  TetMesh linear = in_physical_space(mesh, tissues, image, options.frame);
  if (options.order == 1) return linear;
  return quadratic_mesh(linear, {options.deform.min_dihedral_deg, options.deform.max_dihedral_deg});
}

std::vector<TissueOutcome> describe_tissues(const TissueImage& image, std::span<const double> wanted,
                                            const std::vector<Fidelity>& lattice, const std::vector<Fidelity>& final,
                                            const TissueMesh& mesh) {
  std::vector<TissueOutcome> outcomes;
  for (std::size_t t = 1; t < image.labels.size(); ++t) {
    outcomes.push_back({image.labels[t], image.counts[t], 0, wanted[t], lattice[t].f1(), lattice[t].f2(), final[t].f1(),
                        final[t].f2()});
  }
  for (const TissueId t : mesh.tissues) {
    if (t != 0) ++outcomes[t - 1u].tets;
  }
  return outcomes;
}

namespace {

// "label 3 (1 voxel)"
std::string with_voxels(Label label, std::uint64_t voxels) {
  return "label " + std::to_string(label) + " (" + std::to_string(voxels) + (voxels == 1 ? " voxel)" : " voxels)");
}

}  // namespace

void describe_losses(const std::vector<TissueOutcome>& tissues, std::vector<std::string>& warnings) {
  for (const TissueOutcome& tissue : tissues) {
    if (tissue.tets > 0) continue;
    warnings.push_back(with_voxels(tissue.label, tissue.voxels) +
                       " is too small to be represented and is not in the mesh; a smaller bcc_size may help");
  }
}

void describe_islands(const std::vector<DroppedIsland>& islands, const TissueImage& image,
                      std::vector<std::string>& warnings) {
  std::map<Label, std::pair<std::uint64_t, std::uint64_t>> dropped;  // parts and their voxels
  for (const DroppedIsland& island : islands) {
    auto& [parts, voxels] = dropped[image.labels[island.tissue]];
    ++parts;
    voxels += island.voxels;
  }
  for (const auto& [label, sum] : dropped) {
    warnings.push_back(std::to_string(sum.first) + (sum.first == 1 ? " island of " : " islands of ") +
                       with_voxels(label, sum.second) + " dropped, as drop_islands asks");
  }
}

// A tissue thinner than the lattice can lose most of its volume to the deformation: that must not pass unnoticed.
void describe_shrinkage(const TissueMesh& mesh, const TissueImage& image, std::vector<std::string>& warnings) {
  constexpr double kMuch = 0.5;
  const std::vector<double> volume_mm3 = tissue_volumes_mm3(mesh, image.labels.size());
  for (std::size_t t = 1; t < volume_mm3.size(); ++t) {
    const double off = volume_mm3[t] / image.volume_mm3(t) - 1;
    if (volume_mm3[t] == 0 || std::abs(off) <= kMuch) continue;
    warnings.push_back(with_voxels(image.labels[t], image.counts[t]) + " has " +
                       std::to_string(static_cast<int>(std::round(100 * (1 + off)))) +
                       " % of its volume in the mesh: it is thin for this lattice; a smaller bcc_size may help");
  }
}

// Fidelity that was asked for and is not there is said in one sentence, however many tissues lack it.
void describe_shortfall(const std::vector<TissueOutcome>& tissues, std::vector<std::string>& warnings) {
  const auto lacks = [](const TissueOutcome& t) { return t.tets > 0 ? t.fidelity - std::min(t.f1, t.f2) : 0.0; };
  const auto count = std::ranges::count_if(tissues, [&](const TissueOutcome& t) { return lacks(t) > 0; });
  if (count == 0) return;
  const TissueOutcome& worst = *std::ranges::max_element(tissues, {}, lacks);
  // Rounded down: what falls short must not look as if it did not.
  std::ostringstream shares;
  shares << std::floor(1000 * std::min(worst.f1, worst.f2)) / 1000 << " of " << worst.fidelity;
  warnings.push_back(std::to_string(count) + (count == 1 ? " tissue stays" : " tissues stay") +
                     " below the fidelity asked for, furthest " + with_voxels(worst.label, worst.voxels) + " with " +
                     shares.str() + "; a smaller min_size or looser angle bounds may help");
}

}  // namespace anatomesh
