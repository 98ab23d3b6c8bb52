// Lattices of test images.
#pragma once

#include "lattice/label_lattice.h"

namespace anatomesh::testing {

/// A plan with the same fidelity for every tissue.
inline LatticePlan plan_for(const TissueImage& image, double bcc_size_mm, double fidelity) {
  LatticePlan plan;
  plan.bcc_size_mm = bcc_size_mm;
  plan.fidelity.assign(image.labels.size(), fidelity);
  return plan;
}

inline LabelledLattice build(const TissueImage& image, const LatticePlan& plan) {
  const Progress progress;
  return LabelLattice(image, plan).build(Stage(progress, "lattice", 0, 1));
}

}  // namespace anatomesh::testing
