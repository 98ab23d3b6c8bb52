#include "pipeline/rounds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "anatomesh/errors.h"
#include "deform/deform.h"

namespace anatomesh {
namespace {

// A lattice that has this share of F is the first to be deformed: that costs little, and shows where it must be finer.
constexpr double kFirstShare = 0.75;
// A round that leaves more than this share of what was lacking is the last: what is left is not to be had.
constexpr double kWorthwhile = 0.9;
constexpr int kMaxRounds = 12;
// The last steps of the deformation may take a little fidelity, so a little more is asked for before; where it was not
// enough, more, so many times.
constexpr int kMaxRetries = 2;
constexpr double kReserve = 0.004;
// Of the tetrahedra of a lattice about this share is left when the mesh is finished.
constexpr double kShareLeft = 0.5;
constexpr double kTetsPerLeaf = 10;  // that its refinement adds, with what must follow
// Of the progress.
constexpr double kLatticeShare = 0.2;

double reached_of(const Fidelity& f) { return std::min(f.f1(), f.f2()); }

// Sum over the tissues of what they lack.
double lacking(const std::vector<Fidelity>& reached, const std::vector<double>& wanted) {
  double sum = 0;
  for (std::size_t t = 1; t < reached.size(); ++t) sum += std::max(0.0, wanted[t] - reached_of(reached[t]));
  return sum;
}

double mean_reached(const std::vector<Fidelity>& reached) {
  double sum = 0;
  for (std::size_t t = 1; t < reached.size(); ++t) sum += reached_of(reached[t]);
  return sum / static_cast<double>(reached.size() - 1);
}

class Rounds {
 public:
  Rounds(const TissueImage& image, const LatticePlan& plan, const Options& options, const Stage& stage,
         const std::function<void(std::string)>& stage_done)
      : image_(image),
        options_(options.lattice),
        wanted_(plan.fidelity),
        aim_(with_reserve(plan.fidelity)),
        first_plan_(first_plan(plan, options.lattice)),
        stage_(stage),
        stage_done_(stage_done),
        builder_(image, first_plan_),
        deformer_(image, options.deform, stage) {
    improvement_.sizes = plan.sizes;
    improvement_.gradation = options.deform.gradation > 0 ? options.deform.gradation : improvement_.gradation;
  }

  DeformedMesh run();

 private:
  static std::vector<double> with_reserve(std::vector<double> wanted) {
    for (double& f : wanted) f = std::min(1.0, f + kReserve);
    return wanted;
  }
  static LatticePlan first_plan(LatticePlan plan, const LatticeOptions& options) {
    if (options.fidelity_stage == FidelityStage::final) {
      for (double& f : plan.fidelity) f *= kFirstShare;
    }
    return plan;
  }
  bool may_refine() const { return options_.fidelity_stage == FidelityStage::final && round_ < kMaxRounds; }
  Stage part(double from, double to) const;
  MeshFidelity approach(TissueMesh& mesh) const;
  DeformedMesh finish(TissueMesh mesh, std::size_t target) const;
  bool is_stalled(const MeshFidelity& reached);
  bool exceeds_budget(const TissueMesh& mesh);
  DeformedMesh within_budget(TissueMesh mesh);
  std::optional<LabelledLattice> refine(MeshFidelity& reached);
  bool must_retry(const DeformedMesh& finished);

  const TissueImage& image_;
  const LatticeOptions& options_;
  std::vector<double> wanted_;  // F by tissue
  std::vector<double> aim_;     // what the deformed lattice must have for it
  LatticePlan first_plan_;
  Stage stage_;
  const std::function<void(std::string)>& stage_done_;
  LabelLattice builder_;
  Deformer deformer_;
  ImproveOptions improvement_;
  LabelledLattice lattice_;
  std::optional<DeformedMesh> best_;  // inside the budget
  std::size_t tets_ = 0;              // of the last mesh, as they will be when it is finished
  double lacked_ = 1e9;
  int round_ = 0, retries_ = 0;
};

// The rounds share the progress bar; how many there will be is not known.
Stage Rounds::part(double from, double to) const {
  const auto begin = [](double r) { return kLatticeShare + (1 - kLatticeShare) * (1 - std::pow(0.75, r)); };
  return stage_.part("deform", begin(round_ + from), begin(round_ + to));
}

MeshFidelity Rounds::approach(TissueMesh& mesh) const {
  const Stage stage = part(0, 0.5);
  deformer_.approach(mesh, stage);
  MeshFidelity reached = measure_fidelity(mesh, image_, stage);
  stage_done_("deform");
  return reached;
}

DeformedMesh Rounds::finish(TissueMesh mesh, std::size_t target) const {
  const Stage stage = part(0.5, 1);
  ImproveOptions improvement = improvement_;
  improvement.target_tets = target;
  deformer_.finish(mesh, improvement, stage);
  MeshFidelity reached = measure_fidelity(mesh, image_, stage);
  stage_done_("improve");
  return {std::move(mesh), lattice_.fidelity, std::move(reached)};
}

bool Rounds::is_stalled(const MeshFidelity& reached) {
  const double lacks = lacking(reached.tissues, aim_);
  const bool stalled = lacks > kWorthwhile * lacked_;
  lacked_ = lacks;
  return stalled;
}

std::optional<LabelledLattice> Rounds::refine(MeshFidelity& reached) {
  if (!may_refine() || lacking(reached.tissues, aim_) == 0) return std::nullopt;
  FidelityGap gap = find_gap(reached, image_, aim_);
  if (options_.max_elements > 0) {
    const double room = static_cast<double>(options_.max_elements) - static_cast<double>(tets_);
    gap.max_leaves = static_cast<std::size_t>(std::max(16.0, room / kShareLeft / kTetsPerLeaf));
  }
  ++round_;
  std::optional<LabelledLattice> finer = builder_.refine(gap, part(0, 0));
  stage_done_("lattice");
  return finer;
}

// What the last steps took from a tissue is asked for on top.
bool Rounds::must_retry(const DeformedMesh& finished) {
  if (!may_refine() || retries_ == kMaxRetries || lacking(finished.final.tissues, wanted_) == 0) return false;
  ++retries_;
  for (std::size_t t = 1; t < aim_.size(); ++t) {
    const double lacks = wanted_[t] - reached_of(finished.final.tissues[t]);
    if (lacks > 0) aim_[t] = std::min(1.0, aim_[t] + lacks + kReserve);
  }
  lacked_ = 1e9;
  return true;
}

// Whether the mesh would have too many tetrahedra; one that has not, but nearly, is kept.
bool Rounds::exceeds_budget(const TissueMesh& mesh) {
  const std::size_t tets = tissue_tets(mesh);
  tets_ = static_cast<std::size_t>(kShareLeft * static_cast<double>(tets));
  if (options_.max_elements == 0 || tets <= options_.max_elements) return false;
  DeformedMesh finished = finish(mesh, 0);
  tets_ = tissue_tets(finished.mesh);
  if (tets_ > options_.max_elements) return true;
  best_ = std::move(finished);
  return false;
}

// Of a mesh with its elements thinned out, and the last that had few enough by itself, the more faithful one.
DeformedMesh Rounds::within_budget(TissueMesh mesh) {
  // The last flips may add a few.
  DeformedMesh thinned = finish(std::move(mesh), options_.max_elements - options_.max_elements / 100);
  const std::size_t tets = tissue_tets(thinned.mesh);
  const bool fits = tets <= options_.max_elements;
  if (best_ && (!fits || mean_reached(best_->final.tissues) > mean_reached(thinned.final.tissues)))
    return std::move(*best_);
  if (fits) return thinned;
  throw MeshingFailed("max_elements is " + std::to_string(options_.max_elements) + ", but this image takes about " +
                      std::to_string(tets) + " tetrahedra at least with this bcc_size");
}

DeformedMesh Rounds::run() {
  lattice_ = builder_.build(stage_.part("lattice", 0, kLatticeShare));
  stage_done_("lattice");
  for (;;) {
    TissueMesh mesh = std::move(lattice_.mesh);
    MeshFidelity reached = approach(mesh);
    if (exceeds_budget(mesh)) return within_budget(std::move(mesh));
    std::optional<LabelledLattice> finer;
    const bool stalled = is_stalled(reached);
    if (!stalled) finer = refine(reached);
    if (!finer) {
      DeformedMesh finished = finish(std::move(mesh), 0);
      if (!stalled && must_retry(finished)) finer = refine(finished.final);
      if (!finer) return finished;
    }
    lattice_ = std::move(*finer);
  }
}

}  // namespace

DeformedMesh refine_and_deform(const TissueImage& image, const LatticePlan& plan, const Options& options,
                               const Stage& stage, const std::function<void(std::string)>& stage_done) {
  return Rounds(image, plan, options, stage, stage_done).run();
}

}  // namespace anatomesh
