// The tetrahedra at one vertex, laid out to try many places for that vertex.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mesh/tet_shape.h"

namespace anatomesh {

/// Slack (see slack()) of the tetrahedra at a vertex as a function of where the vertex lies. Eight tetrahedra at a
/// time, by vector instructions where the processor has them: the same bits with and without. First clear(), then
/// add() for each tetrahedron, then close(). Cost: about 4 ns a tetrahedron to add, and for each place.
class StarSlack {
 public:
  void clear() { count_ = 0; }

  /// A tetrahedron (p, b, c, d), where p is the vertex. One of the cushion has slack 1 where it is inside the cushion's
  /// bounds, -1 elsewhere.
  void add(Vec3 b, Vec3 c, Vec3 d, bool is_cushion);
  void close();

  /// The least slack with the vertex at p. Below `enough` it may be that of any tetrahedron below it.
  double at(const ShapeBounds& bounds, Vec3 p, double enough) const;

  /// Whether all tetrahedra are inside their bounds with the vertex at p.
  bool fits(const ShapeBounds& bounds, Vec3 p) const { return at(bounds, p, 0) >= 0; }

  static constexpr std::size_t kLanes = 8;
  using Lanes = std::array<double, kLanes>;
  struct alignas(64) Block {
    Lanes bx, by, bz, cx, cy, cz, dx, dy, dz;
    Lanes nx, ny, nz;  // unit normal of the face bcd, away from p
    Lanes area2;       // twice its area
    Lanes edges;       // sum of its squared edges
    Lanes cushion;     // 1 for a tetrahedron of the cushion
  };

 private:
  std::vector<Block> blocks_;
  std::size_t count_ = 0;
  mutable std::size_t first_ = 0;  // the block that had the least slack last
};

}  // namespace anatomesh
