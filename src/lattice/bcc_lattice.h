// Arithmetic of the body-centred cubic (BCC) lattice and its red refinement, after Molino, Bridson,
// Teran and Fedkiw, "A Crystalline, Red Green Strategy for Meshing Highly Deformable Objects with
// Tetrahedra", 12th International Meshing Roundtable, 2003.
//
// Units: at every level the lattice spacing is 4 units, so that cube corners are at multiples of 4, cube
// centres at 2 plus multiples of 4, edge midpoints and the barycentres of tetrahedra at integers. Going
// one level down doubles all coordinates. A tetrahedron is named by its level and its barycentre b, which has
// one odd coordinate (axis p) and of the other two one that is 2 (axis q) and one that is 0 (axis r)
// modulo 4. Its vertices, in this order, are the two ends of the long edge along q between cube corners
// and the two ends of the long edge along r between cube centres:
//     v0, v1: q = b_q -+ 2, p = the neighbour of b_p that is 0 modulo 4, r = b_r
//     v2, v3: r = b_r -+ 2, p = the neighbour of b_p that is 2 modulo 4, q = b_q
// The red children of a BCC tetrahedron, split along its shortest inner diagonal, are the BCC tetrahedra of
// the next level inside it, so the whole hierarchy needs no stored geometry.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "anatomesh/types.h"

namespace anatomesh {

/// Integer lattice coordinates, in the units of some level.
using LatticePoint = std::array<std::int32_t, 3>;

/// The edges of a tetrahedron as pairs of its vertices: the two long ones first, then the short ones.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges = {{{0, 1}, {2, 3}, {0, 2}, {0, 3}, {1, 2}, {1, 3}}};

/// Red tetrahedra that start in one lattice cube (4 x 4 x 4 units).
inline constexpr int kTetsPerCell = 12;

/// The axes of a tetrahedron and the direction from its corner edge to its centre edge.
struct BccFrame {
  std::size_t p, q, r;
  std::int32_t towards_centre;  ///< +1: the centre edge lies at b_p + 1, the corner edge at b_p - 1; -1: reverse

  explicit BccFrame(const LatticePoint& b) {
    p = (b[0] & 1) ? 0 : (b[1] & 1) ? 1 : 2;
    q = p == 2 ? 0 : p + 1;
    r = 3 - p - q;
    if ((b[q] & 3) == 0) std::swap(q, r);
    towards_centre = (b[p] & 3) == 1 ? 1 : -1;
  }
};

/// A point moved along an axis.
inline LatticePoint shifted(LatticePoint point, std::size_t axis, std::int32_t by) {
  point[axis] += by;
  return point;
}

/// Offsets of a point from the barycentre in the tetrahedron's own axes: along p (towards the centre edge),
/// q and r. The corner edge lies at p = -1, |q| <= 2, r = 0; the centre edge at p = 1, q = 0, |r| <= 2.
struct BccOffset {
  double p, q, r;
  BccOffset(const LatticePoint& b, const BccFrame& f, Vec3 x)
      : p(f.towards_centre * (x[f.p] - b[f.p])), q(x[f.q] - b[f.q]), r(x[f.r] - b[f.r]) {}
};

/// Whether a point is the barycentre of a BCC tetrahedron of its level.
bool is_bcc_barycentre(const LatticePoint& b);

/// The vertices v0 .. v3, see above. Their order is not always positive: see is_positive().
inline std::array<LatticePoint, 4> bcc_vertices(const LatticePoint& b) {
  const BccFrame f(b);
  const LatticePoint corner_mid = shifted(b, f.p, -f.towards_centre);
  const LatticePoint centre_mid = shifted(b, f.p, f.towards_centre);
  return {shifted(corner_mid, f.q, -2), shifted(corner_mid, f.q, 2), shifted(centre_mid, f.r, -2),
          shifted(centre_mid, f.r, 2)};
}

/// Whether v0, v1, v2, v3 are positively oriented.
inline bool is_positive(const LatticePoint& b) {
  const BccFrame f(b);
  const bool even = (f.p + 1) % 3 == f.q;  // (p, q, r) is an even permutation of the axes
  return even == (f.towards_centre < 0);
}

/// Barycentres of the eight red children, in units of the next level: the four at the corners v0 .. v3,
/// then those on the -q, +q, -r, +r side of the inner diagonal.
inline std::array<LatticePoint, 8> bcc_children(const LatticePoint& b) {
  const BccFrame f(b);
  const auto v = bcc_vertices(b);
  const LatticePoint twice = {2 * b[0], 2 * b[1], 2 * b[2]};
  std::array<LatticePoint, 8> children;
  for (std::size_t i = 0; i < 4; ++i) children[i] = {v[i][0] + b[0], v[i][1] + b[1], v[i][2] + b[2]};
  children[4] = shifted(twice, f.q, -1);
  children[5] = shifted(twice, f.q, 1);
  children[6] = shifted(twice, f.r, -1);
  children[7] = shifted(twice, f.r, 1);
  return children;
}

/// Barycentre, in units of the level above, of the tetrahedron that this one is a red child of.
LatticePoint bcc_parent(const LatticePoint& barycentre);

/// Midpoint of edge e (of kTetEdges), in units of the same level.
inline LatticePoint bcc_edge_midpoint(const LatticePoint& b, int edge) {
  const BccFrame f(b);
  if (edge < 2) return shifted(b, f.p, edge == 0 ? -f.towards_centre : f.towards_centre);
  const auto& ends = kTetEdges[static_cast<std::size_t>(edge)];
  return shifted(shifted(b, f.q, ends[0] == 0 ? -1 : 1), f.r, ends[1] == 2 ? -1 : 1);
}

/// The edge (of kTetEdges) of this tetrahedron that has this midpoint; it must be one.
int bcc_edge_at(const LatticePoint& barycentre, const LatticePoint& midpoint);

/// Barycentres of all tetrahedra of a level around the edge with this midpoint: 4 around a long, 6 around
/// a short edge.
struct BccRing {
  std::array<LatticePoint, 6> barycentre;
  int count = 0;
};
BccRing bcc_tets_around(const LatticePoint& edge_midpoint);

/// Position of a tetrahedron among the 12 of its cell, 0 to 11, and back.
inline int bcc_local_index(const LatticePoint& b) {
  const BccFrame f(b);
  return static_cast<int>(f.p) * 4 + ((b[f.p] & 3) == 3 ? 2 : 0) + ((f.p + 1) % 3 == f.q ? 0 : 1);
}

inline LatticePoint bcc_from_local(const LatticePoint& cell, int local) {
  const std::size_t p = static_cast<std::size_t>(local) / 4;
  LatticePoint b = {4 * cell[0], 4 * cell[1], 4 * cell[2]};
  b[p] += (local & 2) ? 3 : 1;
  b[(p + ((local & 1) ? 2 : 1)) % 3] += 2;
  return b;
}

/// Lattice cube that holds a point: coordinates divided by 4, rounded down.
inline LatticePoint bcc_cell(const LatticePoint& point) { return {point[0] >> 2, point[1] >> 2, point[2] >> 2}; }

/// Barycentre of the tetrahedron that holds a real point (in units of the level). Points on shared faces
/// belong to one tetrahedron, always the same.
LatticePoint bcc_locate(Vec3 point);

/// Which of the eight red children (order of bcc_children) holds a point of the tetrahedron: decided by
/// the signs of a few differences, so every point belongs to exactly one child, also on shared faces.
inline int bcc_child_at(const LatticePoint& b, const BccFrame& frame, Vec3 x) {
  const BccOffset d(b, frame, x);
  if (d.q <= -(1 + d.p)) return 0;
  if (d.q >= 1 + d.p) return 1;
  if (d.r <= -(1 - d.p)) return 2;
  if (d.r >= 1 - d.p) return 3;
  if (std::abs(d.q) >= std::abs(d.r)) return d.q < 0 ? 4 : 5;
  return d.r < 0 ? 6 : 7;
}
inline int bcc_child_at(const LatticePoint& barycentre, Vec3 point) {
  return bcc_child_at(barycentre, BccFrame(barycentre), point);
}

/// Barycentric coordinates of a real point, times 4: their sum is 4.
inline std::array<double, 4> bcc_barycentric_times_4(const LatticePoint& b, Vec3 x) {
  const BccOffset d(b, BccFrame(b), x);
  return {1 - d.p - d.q, 1 - d.p + d.q, 1 + d.p - d.r, 1 + d.p + d.r};
}

}  // namespace anatomesh
