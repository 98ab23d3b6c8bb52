#include "pipeline/rounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <cstdio>  /*DBG*/
#include <optional>
#include <utility>

#include "anatomesh/errors.h"
#include "deform/deform.h"
#include "image/boundary_area.h"

namespace anatomesh {
namespace {

// A lattice that has this share of F is the first to be deformed: that costs little, and shows where it must be finer.
constexpr double kFirstShare = 0.75;
// A round that leaves more than this share of what was lacking is the last: what is left is not to be had.
constexpr double kWorthwhile = 0.9;
constexpr int kMaxRounds = 12;
constexpr double kUnknown = std::numeric_limits<double>::infinity();
// The last steps of the deformation may take a little fidelity, so a little more is asked for before; where it was not
// enough, more, so many times.
constexpr int kMaxRetries = 2;
constexpr double kReserve = 0.08;  // of what may be wrong
// Lattices that are built anew, for better spacings of the surfaces.
constexpr int kMaxCorrections = 2;
// A mesh of fewer elements than this share of the budget leaves room for a finer lattice, for this share of it.
constexpr double kRoomy = 0.75, kFull = 0.95;
// Surfaces of tissues of more than kLarge voxels have to lie near their boundary, too: at F = 0.95, the voxels that may
// be wrong are at most a layer of this share of the largest voxel spacing all over the boundary.
constexpr std::uint64_t kLarge = 5000;
constexpr double kLayer = 0.08;
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
  Rounds(const TissueImage& image, const LatticePlan& plan, const SurfaceSizes::Range& range, const Options& options,
         const Stage& stage, const std::function<void(std::string)>& stage_done)
      : image_(image),
        options_(options.lattice),
        wanted_(plan.fidelity),
        aim_(aims(image, plan.fidelity)),
        plan_(plan),
        range_(range),
        sizes_(image, range, aim_),
        stage_(stage),
        stage_done_(stage_done),
        deformer_(image, options.deform, stage) {
    improvement_.sizes = plan.sizes;
    improvement_.gradation = options.deform.gradation > 0 ? options.deform.gradation : improvement_.gradation;
  }

  DeformedMesh run();

 private:
  static std::vector<double> aims(const TissueImage& image, const std::vector<double>& wanted);
  void build();
  bool choose_better(const MeshFidelity& reached);
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
  LatticePlan plan_;
  SurfaceSizes::Range range_;
  SurfaceSizes sizes_;
  SurfaceSizes::Choice choice_;
  Stage stage_;
  const std::function<void(std::string)>& stage_done_;
  std::optional<LabelLattice> builder_;
  Deformer deformer_;
  ImproveOptions improvement_;
  LabelledLattice lattice_;
  std::optional<DeformedMesh> best_;  // inside the budget
  std::size_t tets_ = 0;              // of the last mesh, as they will be when it is finished
  double lacked_ = kUnknown;         // by all tissues in the last round
  int round_ = 0, retries_ = 0, corrections_ = 0;
};

std::vector<double> Rounds::aims(const TissueImage& image, const std::vector<double>& wanted) {
  const std::vector<double> area_mm2 = boundary_areas_mm2(image);
  const double spacing = std::max({image.spacing_mm.x, image.spacing_mm.y, image.spacing_mm.z});
  std::vector<double> aims = wanted;
  for (std::size_t t = 1; t < wanted.size(); ++t) {
    double wrong = 1 - wanted[t];
    if (image.counts[t] > kLarge)
      wrong = std::min(wrong, wrong / 0.05 * kLayer * spacing * area_mm2[t] / image.volume_mm3(t));
    aims[t] = 1 - (1 - kReserve) * wrong;
  }
  return aims;
}

// The first lattice, or one with better spacings.
void Rounds::build() {
  if (options_.fidelity_stage == FidelityStage::final) {
    choice_ = sizes_.choose();
    set_root(plan_, image_, choice_.root_mm, range_.smallest_mm);
    plan_.surface_level = choice_.surface_level;
    plan_.fidelity = wanted_;
    for (double& f : plan_.fidelity) f *= kFirstShare;
  }
  builder_.emplace(image_, plan_);
  lattice_ = builder_->build(stage_.part("lattice", 0, kLatticeShare));
  stage_done_("lattice");
}

// Whether another lattice with other spacings of the surfaces would be better.
bool Rounds::choose_better(const MeshFidelity& reached) {
  if (!may_refine() || corrections_ == kMaxCorrections) return false;
  ++corrections_;
  if (options_.max_elements == 0) return sizes_.correct(choice_, reached.tissues);
  const double room = static_cast<double>(options_.max_elements) / static_cast<double>(tets_);
  if (kRoomy * room < 1 || lacking(reached.tissues, aim_) == 0) return false;
  sizes_.scale(1 / std::sqrt(kFull * room));
  return true;
}

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
  return {std::move(mesh), lattice_.fidelity, std::move(reached), plan_.bcc_size_mm};
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
  std::optional<LabelledLattice> finer = builder_->refine(gap, part(0, 0));
  stage_done_("lattice");
  return finer;
}

// What the last steps took from a tissue is asked for on top.
bool Rounds::must_retry(const DeformedMesh& finished) {
  if (!may_refine() || retries_ == kMaxRetries || lacking(finished.final.tissues, wanted_) == 0) return false;
  ++retries_;
  for (std::size_t t = 1; t < aim_.size(); ++t) {
    const double lacks = wanted_[t] - reached_of(finished.final.tissues[t]);
    if (lacks > 0) aim_[t] = std::min(1.0, aim_[t] + lacks + kReserve * (1 - wanted_[t]));
  }
  lacked_ = kUnknown;
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
  if (options_.max_elements > 0) sizes_.fit_budget(kFull * static_cast<double>(options_.max_elements));
  build();
  for (;;) {
    TissueMesh mesh = std::move(lattice_.mesh);
    MeshFidelity reached = approach(mesh);
    /*DBG*/ { std::vector<double> w; std::size_t lackn=0; for (std::size_t t=1;t<aim_.size();++t) if (reached_of(reached.tissues[t])<aim_[t]) ++lackn; std::fprintf(stderr,"round %d root %.3f levels %d s1 %d tets %zu reached1 %.4f aim1 %.4f mean %.4f lacking %.4f n %zu\n",round_,plan_.bcc_size_mm,plan_.levels,plan_.surface_level.empty()?-1:plan_.surface_level[1],tissue_tets(mesh),reached_of(reached.tissues[1]),aim_[1],mean_reached(reached.tissues),lacking(reached.tissues,aim_),lackn); } /*DBG*/
    if (exceeds_budget(mesh)) return within_budget(std::move(mesh));
    if (choose_better(reached)) {
      ++round_;
      lacked_ = kUnknown;
      build();
      continue;
    }
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

DeformedMesh refine_and_deform(const TissueImage& image, const LatticePlan& plan, const SurfaceSizes::Range& range,
                               const Options& options, const Stage& stage,
                               const std::function<void(std::string)>& stage_done) {
  return Rounds(image, plan, range, options, stage, stage_done).run();
}

}  // namespace anatomesh
