// The one place that knows the order of the stages.
#include "anatomesh/image_to_mesh.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "base/stage.h"
#include "image/components.h"
#include "image/local_thickness.h"
#include "image/tissue_image.h"
#include "lattice/label_lattice.h"
#include "pipeline/checks.h"
#include "pipeline/meshing.h"
#include "pipeline/outcome.h"
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
  plan.fidelity = wanted_fidelity(options, image.labels);
  return plan;
}

}  // namespace

std::vector<double> wanted_fidelity(const LatticeOptions& options, const std::vector<Label>& labels) {
  std::vector<double> wanted(labels.size(), options.fidelity);
  for (std::size_t t = 0; t < labels.size(); ++t) {
    const auto own = options.fidelity_label.find(labels[t]);
    if (own != options.fidelity_label.end()) wanted[t] = own->second;
  }
  return wanted;
}

Meshing mesh_image(const LabelImage& image, const Options& options, bool keeps_background, const Progress& progress) {
  check_image(image);
  Meshing made;
  Result& result = made.result;
  result.options = with_sizes_filled_in(options, image);
  Stopwatch watch(result.times);

  const Stage reading(progress, "labels", 0.0, 0.05);
  TissueImage& tissues = made.image;
  tissues = make_tissue_image(image, options.labels);
  check_labels_exist(result.options, tissues);
  const std::size_t most_tets = tets_that_fit(result.options, image, tissues);
  describe_islands(drop_islands(tissues, options.lattice.drop_islands), tissues, result.warnings);
  watch.stage_done("labels");

  LatticePlan plan = make_plan(tissues, result.options.lattice);
  plan.keeps_background = keeps_background;
  plan.most_tets = most_tets;
  const SizeField sizes = make_sizes(tissues, result.options.lattice, reading);
  if (!sizes.empty()) plan.sizes = &sizes;
  LatticeOptions& lattice = result.options.lattice;
  // The default root spacing is the largest one; a given one is kept.
  const double smallest_root_mm = options.lattice.bcc_size_mm > 0 ? lattice.bcc_size_mm : lattice.bcc_size_mm / 2;
  const SurfaceSizes::Range range = {smallest_root_mm, lattice.bcc_size_mm, lattice.min_size_mm};
  made.deformed = refine_and_deform(tissues, plan, range, result.options, Stage(progress, "lattice", 0.05, 0.95),
                                    [&](std::string name) { watch.stage_done(std::move(name)); });
  lattice.bcc_size_mm = made.deformed.root_mm;

  const Stage finishing(progress, "finish", 0.95, 1.0);
  describe_result(made, plan.fidelity);
  result.mesh = finished_mesh(made.deformed.mesh, tissues, image, options);
  if (result.mesh.tets.empty()) throw MeshingFailed("no tissue could be represented; take a smaller bcc_size");
  watch.stage_done("finish");
  finishing.at(1);
  return made;
}

void describe_result(Meshing& made, std::span<const double> wanted) {
  Result& result = made.result;
  const LatticeOptions& lattice = result.options.lattice;
  result.tissues =
      describe_tissues(made.image, wanted, made.deformed.lattice, made.deformed.final.inside, made.deformed.mesh);
  describe_losses(result.tissues, result.warnings);
  describe_shrinkage(made.deformed.mesh, made.image, result.warnings);
  if (lattice.fidelity_stage == FidelityStage::final && lattice.max_elements == 0)
    describe_shortfall(result.tissues, result.warnings);
}

Result image_to_mesh(const LabelImage& image, const Options& options, const Progress& progress) {
  check_options(options);
  const ThreadLimit threads(options.threads);
  return mesh_image(image, options, false, progress).result;
}

}  // namespace anatomesh
