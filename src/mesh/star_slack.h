// The tetrahedra at one vertex, laid out to try many places for that vertex.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mesh/tet_shape.h"

namespace anatomesh {

/// Slack (see slack()) of the tetrahedra at a vertex as a function of where the vertex lies. Eight tetrahedra at a
/// time, by vector instructions where the processor has them: the same bits with and without. First start(), then
/// add() for each tetrahedron, then close(). Cost: about 3 ns a tetrahedron to add, and for each place.
///
/// Where the bounds keep tetrahedra from being flat (a mean ratio of kSingleRatio or more) all is computed in single
/// precision, and kRounding is taken off the slack, which is more than such tetrahedra can be wrong by: what seems
/// inside the bounds is.
class StarSlack {
 public:
  static constexpr double kSingleRatio = 0.2, kRounding = 1e-4;

  /// origin: a point near the vertex, mm.
  void start(const ShapeBounds& bounds, Vec3 origin);

  /// A tetrahedron (p, b, c, d), where p is the vertex. One of the cushion has slack 1 where it is inside the cushion's
  /// bounds, -1 elsewhere (less kRounding).
  void add(Vec3 b, Vec3 c, Vec3 d, bool is_cushion);
  void close();

  /// The least slack with the vertex at p; 1 without tetrahedra. Below `enough` it may be that of any tetrahedron below
  /// it.
  double at(Vec3 p, double enough) const;

  /// Whether all tetrahedra are inside their bounds with the vertex at p.
  bool fits(Vec3 p) const { return at(p, 0) >= 0; }

  static constexpr std::size_t kLanes = 8;
  template <class Real>
  struct alignas(64) Block {
    using Lanes = std::array<Real, kLanes>;
    Lanes bx, by, bz, cx, cy, cz, dx, dy, dz;
    Lanes nx, ny, nz;  // unit normal of the face bcd, away from p
    Lanes area2;       // twice its area
    Lanes edges;       // sum of its squared edges
    Lanes cushion;     // 1 for a tetrahedron of the cushion
  };

 private:
  template <class Real>
  double least_slack(const std::vector<Block<Real>>& blocks, Vec3 p, double enough) const;

  ShapeBounds bounds_;
  Vec3 origin_;
  bool is_single_ = false;
  std::vector<Block<double>> doubles_;
  std::vector<Block<float>> singles_;
  std::size_t count_ = 0;
  mutable std::size_t first_ = 0;  // the block that had the least slack last
};

}  // namespace anatomesh
