#include "pipeline/rounds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "deform/deform.h"
#include "pipeline/final_fidelity.h"

namespace anatomesh {
namespace {

// A lattice that has this share of F is the first to be deformed: that costs little, and shows where it must be finer.
constexpr double kFirstShare = 0.75;
// Each round mends most of what is wrong. What is left after these is not to be had.
constexpr int kMaxRounds = 16;
// Of the progress.
constexpr double kLatticeShare = 0.2;

bool holds(const std::vector<Fidelity>& reached, const std::vector<double>& wanted) {
  for (std::size_t t = 1; t < reached.size(); ++t) {
    if (reached[t].f1() < wanted[t] || reached[t].f2() < wanted[t]) return false;
  }
  return true;
}

class Rounds {
 public:
  Rounds(const TissueImage& image, const LatticePlan& plan, const Options& options, const Stage& stage,
         const std::function<void(std::string)>& stage_done)
      : image_(image),
        wanted_(plan.fidelity),
        first_plan_(plan),
        stage_(stage),
        stage_done_(stage_done),
        deformer_(image, options.deform, stage) {}

  DeformedMesh run(FidelityStage judged) {
    if (judged == FidelityStage::final) {
      for (double& f : first_plan_.fidelity) f *= kFirstShare;
    }
    LabelLattice builder(image_, first_plan_);
    LabelledLattice lattice = builder.build(stage_.part("lattice", 0, kLatticeShare));
    stage_done_("lattice");
    for (int round = 0;; ++round) {
      const Stage stage = part(round);
      const bool may_refine = judged == FidelityStage::final && round < kMaxRounds;
      TissueMesh mesh = std::move(lattice.mesh);
      MeshFidelity reached;
      std::optional<LabelledLattice> finer;
      for (const bool finished : {false, true}) {
        if (finished) {
          deformer_.finish(mesh, {}, stage.part("deform", 0.5, 1));
        } else {
          deformer_.approach(mesh, stage.part("deform", 0, 0.5));
        }
        reached = measure_fidelity(mesh, image_, stage);
        stage_done_("deform");
        if (may_refine && !holds(reached.tissues, wanted_)) {
          finer = builder.refine(find_gap(reached, image_, wanted_), stage);
          stage_done_("lattice");
        }
        if (finer) break;
      }
      if (!finer) return {std::move(mesh), std::move(lattice.fidelity), std::move(reached.tissues)};
      lattice = std::move(*finer);
    }
  }

 private:
  // The rounds share the progress bar; how many there will be is not known.
  Stage part(int round) const {
    const auto begin = [](int r) { return kLatticeShare + (1 - kLatticeShare) * (1 - std::pow(0.75, r)); };
    return stage_.part("deform", begin(round), begin(round + 1));
  }

  const TissueImage& image_;
  std::vector<double> wanted_;
  LatticePlan first_plan_;
  Stage stage_;
  const std::function<void(std::string)>& stage_done_;
  Deformer deformer_;
};

}  // namespace

DeformedMesh refine_and_deform(const TissueImage& image, const LatticePlan& plan, const Options& options,
                               const Stage& stage, const std::function<void(std::string)>& stage_done) {
  return Rounds(image, plan, options, stage, stage_done).run(options.lattice.fidelity_stage);
}

}  // namespace anatomesh
