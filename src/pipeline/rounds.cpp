#include "pipeline/rounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
// From round to round twice as many of the wrong voxels that are left are asked for, so many times.
constexpr int kMaxDoublings = 4;
constexpr double kUnknown = std::numeric_limits<double>::infinity();
// The last steps of the deformation may take a little fidelity, so a little more is asked for before; where it was not
// enough, more, so many times.
constexpr int kMaxRetries = 2;
constexpr double kReserve = 0.08;  // of what may be wrong
// Lattices that are built anew, for better spacings of the surfaces.
constexpr int kMaxCorrections = 2;
// Of a budget: a lattice is meant to fill so much of it, one of less leaves room for a finer one, and one of more is
// not worth thinning out as long as there is another try.
constexpr double kFull = 0.95, kRoomy = 0.75, kFar = 1.3;
constexpr int kMaxTries = 4;
// Tissues lacking so many times what they lack in the mean are refined locally within a budget.
constexpr double kWorst = 2;
// Of the tetrahedra of a lattice about this share is left when the mesh is finished.
constexpr double kShareLeft = 0.6;
// Surfaces of tissues of more voxels have to lie near their boundary, too.
constexpr std::uint64_t kLarge = 5000;
// Voxels far from the mesh's surfaces are cared for where there is one of them to so many on the tissue's boundary, in
// so many rounds.
constexpr double kMissed = 0.015;
constexpr int kMaxMissedRounds = 2;
// Spacing, in mean voxel spacings, that is fine enough for them; within a budget a coarser one has to do.
constexpr double kFineEnough = 1.5, kFineEnoughWithin = 2.5;
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
    area_mm2_ = boundary_areas_mm2(image);
    for (const std::uint64_t voxels : image.counts) is_large_.push_back(voxels > kLarge);
    is_large_[0] = 0;
    improvement_.sizes = plan.sizes;
    improvement_.gradation = options.deform.gradation > 0 ? options.deform.gradation : improvement_.gradation;
  }

  /// Until every tissue has its fidelity.
  DeformedMesh run();
  /// As faithful as so many tetrahedra allow.
  DeformedMesh run_within(std::size_t max_elements);

 private:
  // What a deformed mesh has reached, and the voxels that it misses altogether.
  struct Reached {
    MeshFidelity mesh;
    FarVoxels far;
  };
  static std::vector<double> aims(const TissueImage& image, const std::vector<double>& wanted);
  void build();
  bool choose_better(const Reached& reached);
  bool may_refine() const { return options_.fidelity_stage == FidelityStage::final && round_ < kMaxRounds; }
  Stage part(double from, double to) const;
  Reached approach(TissueMesh& mesh) const;
  bool misses_much(const FarVoxels& far) const;
  DeformedMesh finish(TissueMesh mesh, std::size_t target) const;
  // So many tetrahedra, and the best mesh that has no more.
  struct Budget {
    std::size_t most = 0;
    double share_left = kShareLeft;
    std::optional<DeformedMesh> best;
    double filled_by(const TissueMesh& mesh) const {
      return share_left * static_cast<double>(tissue_tets(mesh)) / static_cast<double>(most);
    }
  };
  std::optional<TissueMesh> refine_worst(Reached& reached);
  void finish_within(Budget& budget, const TissueMesh& mesh) const;
  bool is_stalled(const Reached& reached);
  bool lacks_much(const std::vector<Fidelity>& reached) const;
  void ask_for_missed(FidelityGap& gap, Reached& reached, double voxels) const;
  std::optional<LabelledLattice> refine(Reached& reached, bool for_fidelity);
  bool must_retry(const std::vector<Fidelity>& approached, const std::vector<Fidelity>& finished);

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
  std::vector<double> area_mm2_;  // by tissue
  std::vector<char> is_large_;    // by tissue
  double lacked_ = kUnknown;      // by all tissues in the last round
  int round_ = 0, local_rounds_ = 0, retries_ = 0, corrections_ = 0, missed_rounds_ = 0;
};

std::vector<double> Rounds::aims(const TissueImage& image, const std::vector<double>& wanted) {
  const std::vector<double> area_mm2 = boundary_areas_mm2(image);
  std::vector<double> aims = wanted;
  for (std::size_t t = 1; t < wanted.size(); ++t) {
    double wrong = 1 - wanted[t];
    if (image.counts[t] > kLarge)
      wrong = std::min(wrong, wrong_layer_mm(image, wrong) * area_mm2[t] / image.volume_mm3(t));
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
  lattice_ = builder_->build(round_ == 0 ? stage_.part("lattice", 0, kLatticeShare) : part(0, 0));
  stage_done_("lattice");
}

// Whether another lattice with other spacings of the surfaces would be better.
bool Rounds::choose_better(const Reached& reached) {
  if (!may_refine() || corrections_ == kMaxCorrections) return false;
  const bool better = sizes_.correct(choice_, reached.far.others);
  corrections_ = better ? corrections_ + 1 : kMaxCorrections;
  return better;
}

// The rounds share the progress bar; how many there will be is not known.
Stage Rounds::part(double from, double to) const {
  const auto begin = [](double r) { return kLatticeShare + (1 - kLatticeShare) * (1 - std::pow(0.75, r)); };
  return stage_.part("deform", begin(round_ + from), begin(round_ + to));
}

Rounds::Reached Rounds::approach(TissueMesh& mesh) const {
  const Stage stage = part(0, 0.5);
  deformer_.approach(mesh, stage);
  Reached reached;
  reached.mesh = measure_fidelity(mesh, image_, stage);
  reached.far = find_far_voxels(reached.mesh, image_, is_large_);
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
  DeformedMesh finished = {std::move(mesh), {}, {}, lattice_.fidelity, std::move(reached), plan_.bcc_size_mm};
  if (plan_.keeps_background) {
    finished.beyond = builder_->background();
    finished.voxel_weights = deformer_.field().weights();
  }
  return finished;
}

// Whether so much of a tissue's boundary lies far from the mesh's that it shows in the distances.
bool Rounds::misses_much(const FarVoxels& far) const {
  const Vec3 s = image_.spacing_mm;
  const double face_mm2 = std::cbrt(s.x * s.y * s.z) * std::cbrt(s.x * s.y * s.z);
  for (std::size_t t = 1; t < area_mm2_.size(); ++t) {
    if (is_large_[t] && static_cast<double>(far.of_tissue[t]) * face_mm2 > kMissed * area_mm2_[t]) return true;
  }
  return false;
}

bool Rounds::is_stalled(const Reached& reached) {
  const double lacks = lacking(reached.mesh.tissues, aim_);
  const bool stalled = lacks > kWorthwhile * lacked_;
  lacked_ = lacks;
  return stalled;
}

void Rounds::ask_for_missed(FidelityGap& gap, Reached& reached, double voxels) const {
  const Vec3 s = image_.spacing_mm;
  gap.missed = std::move(reached.far.voxels);
  gap.missed_size_mm = voxels * (s.x + s.y + s.z) / 3;
}

// Whether a tissue has not even half of the reserve.
bool Rounds::lacks_much(const std::vector<Fidelity>& reached) const {
  for (std::size_t t = 1; t < aim_.size(); ++t) {
    if (reached_of(reached[t]) < aim_[t] - 0.5 * kReserve * (1 - aim_[t])) return true;
  }
  return false;
}

std::optional<LabelledLattice> Rounds::refine(Reached& reached, bool for_fidelity) {
  if (!may_refine()) return std::nullopt;
  const bool missing = missed_rounds_ < kMaxMissedRounds && misses_much(reached.far);
  for_fidelity = for_fidelity && lacks_much(reached.mesh.tissues);
  if (!missing && !for_fidelity) return std::nullopt;
  FidelityGap gap = find_gap(reached.mesh, image_, for_fidelity ? aim_ : std::vector<double>(aim_.size(), 0));
  if (missing) {
    ++missed_rounds_;
    ask_for_missed(gap, reached, kFineEnough);
  }
  // Not all that is refined becomes right: twice as much is asked for, then four times what is left ...
  local_rounds_ = std::min(local_rounds_ + 1, kMaxDoublings);
  for (std::uint64_t& voxels : gap.to_mend) voxels <<= local_rounds_;
  ++round_;
  std::optional<LabelledLattice> finer = builder_->refine(gap, part(0, 0));
  stage_done_("lattice");
  return finer;
}

// What the last steps took from a tissue is asked for on top; what it lacked before cannot be had by that.
bool Rounds::must_retry(const std::vector<Fidelity>& approached, const std::vector<Fidelity>& finished) {
  if (!may_refine() || retries_ == kMaxRetries) return false;
  bool any = false;
  for (std::size_t t = 1; t < aim_.size(); ++t) {
    const double lacks = wanted_[t] - reached_of(finished[t]);
    if (lacks <= 0 || reached_of(approached[t]) < wanted_[t]) continue;
    aim_[t] = std::min(1.0, aim_[t] + lacks + kReserve * (1 - wanted_[t]));
    any = true;
  }
  if (!any) return false;
  ++retries_;
  lacked_ = kUnknown;
  return true;
}

DeformedMesh Rounds::run() {
  build();
  if (options_.fidelity_stage == FidelityStage::lattice) {
    builder_.reset();  // no other lattice will be asked for: room for the deformation
    deformer_.approach(lattice_.mesh, part(0, 0.5));
    stage_done_("deform");
    return finish(std::move(lattice_.mesh), 0);
  }
  for (;;) {
    TissueMesh mesh = std::move(lattice_.mesh);
    Reached reached = approach(mesh);
    if (choose_better(reached)) {
      ++round_;
      lacked_ = kUnknown;
      build();
      continue;
    }
    const bool stalled = is_stalled(reached);
    std::optional<LabelledLattice> finer = refine(reached, !stalled);
    if (!finer) {
      DeformedMesh finished = finish(std::move(mesh), 0);
      if (stalled || !must_retry(reached.mesh.tissues, finished.final.tissues)) return finished;
      reached.mesh = std::move(finished.final);
      finer = refine(reached, true);
      if (!finer) {
        finished.final = std::move(reached.mesh);
        return finished;
      }
    }
    lattice_ = std::move(*finer);
  }
}

// What helps most where the spacings come from a budget: to have what the mesh misses, and its worst tissues. Nothing
// where there is nothing of that kind.
std::optional<TissueMesh> Rounds::refine_worst(Reached& reached) {
  const double least = 1 - kWorst * (1 - mean_reached(reached.mesh.tissues));
  std::vector<double> asked(wanted_.size());
  for (std::size_t t = 1; t < asked.size(); ++t) asked[t] = std::min(least, wanted_[t]);
  const bool missing = misses_much(reached.far);
  if (!may_refine() || !(missing || lacking(reached.mesh.tissues, asked) > 0)) return std::nullopt;
  FidelityGap gap = find_gap(reached.mesh, image_, asked);
  if (missing) ask_for_missed(gap, reached, kFineEnoughWithin);
  std::optional<LabelledLattice> finer = builder_->refine(gap, part(0, 0));
  stage_done_("lattice");
  if (!finer) return std::nullopt;
  reached = approach(finer->mesh);
  return std::move(finer->mesh);
}

// Finishes a mesh, and where it has more tetrahedra than it may have once more, thinned out.
void Rounds::finish_within(Budget& budget, const TissueMesh& mesh) const {
  const auto keep = [&](DeformedMesh finished) {
    if (tissue_tets(finished.mesh) > budget.most) return;
    if (!budget.best || mean_reached(finished.final.tissues) > mean_reached(budget.best->final.tissues))
      budget.best = std::move(finished);
  };
  DeformedMesh finished = finish(mesh, 0);
  budget.share_left = static_cast<double>(tissue_tets(finished.mesh)) / static_cast<double>(tissue_tets(mesh));
  keep(std::move(finished));
  // The last flips may add a few.
  if (budget.filled_by(mesh) > 1) keep(finish(mesh, budget.most - budget.most / 100));
}

// All spacings become larger or smaller until the finished mesh nearly fills the budget. The most faithful one of those
// inside it is the result.
DeformedMesh Rounds::run_within(std::size_t max_elements) {
  Budget budget;
  budget.most = max_elements;
  sizes_.fit_budget(kFull * static_cast<double>(max_elements));
  double least = kUnknown;
  for (bool is_last = false; !is_last; ++round_) {
    build();
    TissueMesh mesh = std::move(lattice_.mesh);
    Reached reached = approach(mesh);
    std::optional<TissueMesh> finer;
    if (budget.filled_by(mesh) < kFar) finer = refine_worst(reached);
    double filled = budget.filled_by(finer ? *finer : mesh);
    const auto suits = [&] {
      return filled < kFar && !(filled < kRoomy && lacking(reached.mesh.tissues, wanted_) > 0);
    };
    SurfaceSizes next = sizes_;
    next.scale(std::sqrt(filled / kFull));
    is_last = round_ + 1 == kMaxTries || next.choose() == choice_;
    if (is_last || suits()) {
      const TissueMesh& best = finer && filled < kFar ? *finer : mesh;
      finish_within(budget, best);
      filled = budget.filled_by(best);
      is_last = is_last || (budget.best && suits());
    }
    sizes_.scale(std::sqrt(filled / kFull));
    least = std::min(least, filled * static_cast<double>(max_elements));
  }
  if (budget.best) return std::move(*budget.best);
  throw MeshingFailed("max_elements is " + std::to_string(max_elements) + ", but this image takes about " +
                      std::to_string(static_cast<std::size_t>(least)) + " tetrahedra at least with this bcc_size");
}

}  // namespace

DeformedMesh refine_and_deform(const TissueImage& image, const LatticePlan& plan, const SurfaceSizes::Range& range,
                               const Options& options, const Stage& stage,
                               const std::function<void(std::string)>& stage_done) {
  Rounds rounds(image, plan, range, options, stage, stage_done);
  return options.lattice.max_elements > 0 ? rounds.run_within(options.lattice.max_elements) : rounds.run();
}

}  // namespace anatomesh
