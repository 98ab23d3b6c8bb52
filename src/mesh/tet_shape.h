// Shape of a tetrahedron, and tests against bounds without an inverse trigonometric function.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "anatomesh/types.h"
#include "base/vec.h"

namespace anatomesh {

/// Six times the signed volume.
inline double six_volumes(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a); }

/// What the guard looks at.
struct ShapeMeasure {
  double largest_cos = 1;    ///< cosine of the smallest dihedral angle
  double smallest_cos = -1;  ///< cosine of the largest dihedral angle
  double mean_ratio = 0;     ///< 12 (3 V)^(2/3) / sum of squared edges; 0 when not positively oriented
};

/// Bounds on the shape of a tetrahedron.
struct ShapeBounds {
  double largest_cos = 1;
  double smallest_cos = -1;
  double min_mean_ratio = 0;

  /// Angles in degrees. The bounds are kept with a margin of 1e-6 degrees and 1e-9 of mean ratio, so that they
  /// still hold after the change of frame and on the coordinates as written.
  static ShapeBounds from_degrees(double min_dihedral_deg, double max_dihedral_deg, double min_mean_ratio) {
    constexpr double kRadians = std::numbers::pi / 180, kMarginDeg = 1e-6;
    return {std::cos((min_dihedral_deg + kMarginDeg) * kRadians), std::cos((max_dihedral_deg - kMarginDeg) * kRadians),
            min_mean_ratio + 1e-9};
  }

  bool hold(const ShapeMeasure& s) const {
    return s.mean_ratio >= min_mean_ratio && s.largest_cos <= largest_cos && s.smallest_cos >= smallest_cos;
  }
};

/// Shape of a positively oriented tetrahedron; of any other one that breaks all bounds. Cost: about 30 ns.
inline ShapeMeasure measure_shape(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b, cd = d - c;
  const double volume6 = dot(cross(ab, ac), ad);
  if (!(volume6 > 0)) return {};
  // Outward normals of the faces opposite to a, b, c, d.
  const Vec3 na = cross(bc, bd), nb = cross(ad, ac), nc = cross(ab, ad), nd = cross(ac, ab);
  const double la = 1 / norm(na), lb = 1 / norm(nb), lc = 1 / norm(nc), ld = 1 / norm(nd);
  const std::array<double, 6> cosines = {-dot(na, nb) * la * lb, -dot(na, nc) * la * lc, -dot(na, nd) * la * ld,
                                         -dot(nb, nc) * lb * lc, -dot(nb, nd) * lb * ld, -dot(nc, nd) * lc * ld};
  ShapeMeasure shape;
  shape.largest_cos = *std::max_element(cosines.begin(), cosines.end());
  shape.smallest_cos = *std::min_element(cosines.begin(), cosines.end());
  const double edges =
      norm_squared(ab) + norm_squared(ac) + norm_squared(ad) + norm_squared(bc) + norm_squared(bd) + norm_squared(cd);
  const double half_volume6 = 0.5 * volume6;  // = 3 V
  shape.mean_ratio = 12 * std::cbrt(half_volume6 * half_volume6) / edges;
  return shape;
}

}  // namespace anatomesh
