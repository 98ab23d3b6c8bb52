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

  /// Angles in degrees. However loose the bounds, a mean ratio of 0.01 is kept, so that volumes stay positive and
  /// vertices apart. The bounds are kept with a margin of 1e-6 degrees and 1e-9 of mean ratio, so that they still hold
  /// after the change of frame and on the coordinates as written.
  static ShapeBounds from_degrees(double min_dihedral_deg, double max_dihedral_deg, double min_mean_ratio) {
    constexpr double kRadians = std::numbers::pi / 180, kMarginDeg = 1e-6;
    return {std::cos((min_dihedral_deg + kMarginDeg) * kRadians), std::cos((max_dihedral_deg - kMarginDeg) * kRadians),
            std::max(min_mean_ratio, 0.01) + 1e-9};
  }

  bool hold(const ShapeMeasure& s) const {
    return s.mean_ratio >= min_mean_ratio && s.largest_cos <= largest_cos && s.smallest_cos >= smallest_cos;
  }
};

/// The parts that the measures and tests below share. Cost: about 15 ns.
struct TetGeometry {
  double volume6;                ///< six times the signed volume
  double edges;                  ///< sum of the squared edges
  std::array<double, 4> area2;   ///< twice the area of the face opposite to each vertex
  std::array<double, 6> cosine;  ///< area-weighted: cosine of each dihedral angle times both areas2
  std::array<double, 6> areas;   ///< the products of areas2 that go with them

  TetGeometry(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const Vec3 ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b, cd = d - c;
    // Outward normals of the faces opposite to a, b, c, d.
    const Vec3 na = cross(bc, bd), nb = cross(ad, ac), nc = cross(ab, ad), nd = cross(ac, ab);
    volume6 = -dot(nd, ad);
    edges =
        norm_squared(ab) + norm_squared(ac) + norm_squared(ad) + norm_squared(bc) + norm_squared(bd) + norm_squared(cd);
    area2 = {norm(na), norm(nb), norm(nc), norm(nd)};
    cosine = {-dot(na, nb), -dot(na, nc), -dot(na, nd), -dot(nb, nc), -dot(nb, nd), -dot(nc, nd)};
    areas = {area2[0] * area2[1], area2[0] * area2[2], area2[0] * area2[3],
             area2[1] * area2[2], area2[1] * area2[3], area2[2] * area2[3]};
  }

  /// Cosines of the smallest and of the largest dihedral angle.
  struct CosineRange {
    double largest = -1, smallest = 1;
  };
  CosineRange cosine_range() const {
    CosineRange range;
    for (std::size_t e = 0; e < 6; ++e) {
      const double c = cosine[e] / areas[e];
      range.largest = std::max(range.largest, c);
      range.smallest = std::min(range.smallest, c);
    }
    return range;
  }
};

/// Shape of a positively oriented tetrahedron; of any other one that breaks all bounds.
inline ShapeMeasure measure_shape(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const TetGeometry g(a, b, c, d);
  if (!(g.volume6 > 0)) return {};
  const auto [largest_cos, smallest_cos] = g.cosine_range();
  const double half_volume6 = 0.5 * g.volume6;  // = 3 V
  return {largest_cos, smallest_cos, 12 * std::cbrt(half_volume6 * half_volume6) / g.edges};
}

/// bounds.hold(measure_shape(a, b, c, d)) without an inverse trigonometric function, a cube root or a division.
inline bool within(const ShapeBounds& bounds, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const TetGeometry g(a, b, c, d);
  const double half_volume6 = 0.5 * g.volume6, mean_edge = bounds.min_mean_ratio / 12 * g.edges;
  bool inside = g.volume6 > 0 && half_volume6 * half_volume6 >= mean_edge * mean_edge * mean_edge;
  for (std::size_t e = 0; e < 6; ++e)
    inside &= g.cosine[e] <= bounds.largest_cos * g.areas[e] && g.cosine[e] >= bounds.smallest_cos * g.areas[e];
  return inside;
}

/// How far a tetrahedron is from its bounds: the smallest of the margins of both cosines and of the mean ratio; of the
/// latter the margin of its cube, divided by the cube's slope at the bound, which takes no root. Not negative exactly
/// inside the bounds, 1 at the most; -1 when not positively oriented. Cost: about 20 ns.
inline double slack(const ShapeBounds& bounds, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const TetGeometry g(a, b, c, d);
  if (!(g.volume6 > 0)) return -1;
  const auto [largest, smallest] = g.cosine_range();
  const double bound = bounds.min_mean_ratio;
  const double ratio3 = 432 * g.volume6 * g.volume6 / (g.edges * g.edges * g.edges);
  return std::min({bounds.largest_cos - largest, smallest - bounds.smallest_cos,
                   (ratio3 - bound * bound * bound) / (3 * bound * bound)});
}

/// Bounds of the cushion: positive volumes with a little to spare.
inline constexpr ShapeBounds kCushionBounds = {1, -1, 0.05};

/// The two corners of each edge of a tetrahedron.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kEdgeCorners = {
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The corners of a tetrahedron in even permutations, by the corner that they begin with.
inline constexpr std::array<std::array<std::size_t, 4>, 4> kCornersFrom = {
    {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};

/// The other corners of a tetrahedron, in the order in which they follow its corner v in an even permutation.
inline std::array<VertexId, 3> corners_after(const std::array<VertexId, 4>& tet, VertexId v) {
  const auto& order = kCornersFrom[static_cast<std::size_t>(std::find(tet.begin(), tet.end(), v) - tet.begin())];
  return {tet[order[1]], tet[order[2]], tet[order[3]]};
}

}  // namespace anatomesh
