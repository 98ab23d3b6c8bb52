// The one place that knows the order of the stages.
#include "anatomesh/image_to_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/rotation.h"
#include "base/stage.h"
#include "base/vec.h"
#include "image/components.h"
#include "image/local_thickness.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "mesh/tet_shape.h"
#include "pipeline/checks.h"
#include "pipeline/rounds.h"
#include "pipeline/surface_sizes.h"

namespace anatomesh {
namespace {

class Stopwatch {
 public:
  explicit Stopwatch(std::vector<StageTime>& times) : times_(times) {}
  void stage_done(std::string name) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    start_ = now;
    const auto same = std::ranges::find(times_, name, &StageTime::stage);
    if (same == times_.end()) {
      times_.push_back({std::move(name), seconds});
    } else {
      same->seconds += seconds;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::vector<StageTime>& times_;
  Clock::time_point start_ = Clock::now();
};

// Number of a tissue that is in the image.
std::size_t tissue_of(const TissueImage& image, Label label) {
  return static_cast<std::size_t>(std::ranges::lower_bound(image.labels, label) - image.labels.begin());
}

// No edge has to be shorter than a voxel. A tissue is followed where it is thinner than so many of the coarsest
// tetrahedra are wide.
SizeField make_sizes(const TissueImage& image, const LatticeOptions& options, const Stage& stage) {
  SizeField sizes{image, {}, {}};
  if (!options.size_label.empty()) sizes.of_tissue_mm.assign(image.labels.size(), kNoSize);
  for (const auto& [label, size] : options.size_label) sizes.of_tissue_mm[tissue_of(image, label)] = size;
  if (options.elements_across == 0) return sizes;
  const double across = options.elements_across;
  sizes.of_voxel_mm = local_thickness(image, across * options.bcc_size_mm, stage.cancel_token());
  const double voxel = std::min({image.spacing_mm.x, image.spacing_mm.y, image.spacing_mm.z});
  for (float& size : sizes.of_voxel_mm) size = static_cast<float>(std::max(size / across, voxel));
  return sizes;
}

LatticePlan make_plan(const TissueImage& image, const LatticeOptions& options) {
  LatticePlan plan;
  set_root(plan, image, options.bcc_size_mm, options.min_size_mm);
  plan.allow_non_manifold = options.allow_non_manifold;
  plan.fidelity.assign(image.labels.size(), options.fidelity);
  for (const auto& [label, fidelity] : options.fidelity_label) {
    plan.fidelity[tissue_of(image, label)] = fidelity;
  }
  return plan;
}

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

// Drops the cushion and the vertices that only it used; tissue numbers become labels.
TetMesh finish(const TissueMesh& mesh, const TissueImage& image, const ToPhysical& to_physical) {
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
    result.labels.push_back(image.labels[mesh.tissues[t]]);
  }
  return result;
}

std::vector<TissueOutcome> describe_tissues(const TissueImage& image, const LatticePlan& plan,
                                            const DeformedMesh& deformed) {
  std::vector<TissueOutcome> outcomes;
  for (std::size_t t = 1; t < image.labels.size(); ++t) {
    outcomes.push_back({image.labels[t], image.counts[t], 0, plan.fidelity[t], deformed.lattice[t].f1(),
                        deformed.lattice[t].f2(), deformed.final.inside[t].f1(), deformed.final.inside[t].f2()});
  }
  for (const TissueId t : deformed.mesh.tissues) {
    if (t != 0) ++outcomes[t - 1u].tets;
  }
  return outcomes;
}

// "label 3 (1 voxel)"
std::string with_voxels(Label label, std::uint64_t voxels) {
  return "label " + std::to_string(label) + " (" + std::to_string(voxels) + (voxels == 1 ? " voxel)" : " voxels)");
}

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
  std::vector<double> volume_mm3(image.labels.size(), 0);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& v = mesh.tets[t];
    volume_mm3[mesh.tissues[t]] +=
        six_volumes(mesh.points_mm[v[0]], mesh.points_mm[v[1]], mesh.points_mm[v[2]], mesh.points_mm[v[3]]) / 6;
  }
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

}  // namespace

Result image_to_mesh(const LabelImage& image, const Options& options, const Progress& progress) {
  check_options(options);
  check_image(image);
  const ThreadLimit threads(options.threads);
  Result result;
  result.options = with_sizes_filled_in(options, image);
  Stopwatch watch(result.times);

  const Stage reading(progress, "labels", 0.0, 0.05);
  TissueImage tissues = make_tissue_image(image, options.labels);
  check_labels_exist(result.options, tissues);
  check_memory(result.options, image, tissues);
  describe_islands(drop_islands(tissues, options.lattice.drop_islands), tissues, result.warnings);
  watch.stage_done("labels");

  LatticePlan plan = make_plan(tissues, result.options.lattice);
  const SizeField sizes = make_sizes(tissues, result.options.lattice, reading);
  if (!sizes.empty()) plan.sizes = &sizes;
  LatticeOptions& lattice = result.options.lattice;
  // The default root spacing is the largest one; a given one is kept.
  const double smallest_root_mm = options.lattice.bcc_size_mm > 0 ? lattice.bcc_size_mm : lattice.bcc_size_mm / 2;
  const SurfaceSizes::Range range = {smallest_root_mm, lattice.bcc_size_mm, lattice.min_size_mm};
  const DeformedMesh deformed =
      refine_and_deform(tissues, plan, range, result.options, Stage(progress, "lattice", 0.05, 0.95),
                        [&](std::string name) { watch.stage_done(std::move(name)); });
  lattice.bcc_size_mm = deformed.root_mm;

  const Stage finishing(progress, "finish", 0.95, 1.0);
  result.tissues = describe_tissues(tissues, plan, deformed);
  describe_losses(result.tissues, result.warnings);
  describe_shrinkage(deformed.mesh, tissues, result.warnings);
  if (lattice.fidelity_stage == FidelityStage::final && lattice.max_elements == 0)
    describe_shortfall(result.tissues, result.warnings);
  result.mesh = finish(deformed.mesh, tissues, ToPhysical(image, options.frame));
  if (result.mesh.tets.empty()) throw MeshingFailed("no tissue could be represented; take a smaller bcc_size");
  watch.stage_done("finish");
  finishing.at(1);
  return result;
}

}  // namespace anatomesh
