// The uniform cubic B-spline in one dimension.
#pragma once

#include <array>

namespace anatomesh {

/// Weights of the four voxels around a point at t (0 to 1) between the middle two; they add up to 1.
inline std::array<double, 4> spline_weights(double t) {
  const double s = 1 - t;
  const double inner0 = (4 - 3 * t * t * (2 - t)) / 6;
  const double inner1 = (4 - 3 * s * s * (2 - s)) / 6;
  return {s * s * s / 6, inner0, inner1, t * t * t / 6};
}

/// Their derivatives by t.
inline std::array<double, 4> spline_slopes(double t) {
  const double s = 1 - t;
  return {-0.5 * s * s, 0.5 * t * (3 * t - 4), -0.5 * s * (3 * s - 4), 0.5 * t * t};
}

}  // namespace anatomesh
