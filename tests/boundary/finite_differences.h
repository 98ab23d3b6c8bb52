// The derivatives of a field, compared with its differences.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "base/vec.h"
#include "image/tissue_image.h"

namespace anatomesh::testing {

template <class Field>
void expect_gradients_of_finite_differences(const Field& field, std::span<const TissueId> tissues, Vec3 p,
                                            double tolerance) {
  constexpr double kStep = 1e-5;
  std::vector<double> values(tissues.size()), ahead(tissues.size()), behind(tissues.size());
  std::vector<Vec3> gradients(tissues.size()), unused(tissues.size());
  field.evaluate(p, tissues, values, gradients);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 step;
    step[axis] = kStep;
    field.evaluate(p + step, tissues, ahead, unused);
    field.evaluate(p - step, tissues, behind, unused);
    for (std::size_t t = 0; t < tissues.size(); ++t)
      EXPECT_NEAR(gradients[t][axis], (ahead[t] - behind[t]) / (2 * kStep), tolerance);
  }
}

}  // namespace anatomesh::testing
