#include "lattice/bcc_lattice.h"

#include <cmath>
#include <utility>

namespace anatomesh {
namespace {

// Offsets of a point from the barycentre in the tetrahedron's own axes: along p (towards the centre edge),
// q and r. The corner edge lies at p = -1, |q| <= 2, r = 0; the centre edge at p = 1, q = 0, |r| <= 2.
struct LocalOffset {
  double p, q, r;
  LocalOffset(const LatticePoint& b, const BccFrame& f, Vec3 x)
      : p(f.towards_centre * (x[f.p] - b[f.p])), q(x[f.q] - b[f.q]), r(x[f.r] - b[f.r]) {}
};

LatticePoint shifted(LatticePoint point, std::size_t axis, std::int32_t by) {
  point[axis] += by;
  return point;
}

}  // namespace

bool is_bcc_barycentre(const LatticePoint& b) {
  std::array<int, 4> seen = {0, 0, 0, 0};
  for (const std::int32_t c : b) ++seen[static_cast<std::size_t>(c & 3)];
  return seen[0] == 1 && seen[2] == 1;
}

std::array<LatticePoint, 4> bcc_vertices(const LatticePoint& b) {
  const BccFrame f(b);
  const LatticePoint corner_mid = shifted(b, f.p, -f.towards_centre);
  const LatticePoint centre_mid = shifted(b, f.p, f.towards_centre);
  return {shifted(corner_mid, f.q, -2), shifted(corner_mid, f.q, 2), shifted(centre_mid, f.r, -2),
          shifted(centre_mid, f.r, 2)};
}

bool is_positive(const LatticePoint& b) {
  const BccFrame f(b);
  const bool even = (f.p + 1) % 3 == f.q;  // (p, q, r) is an even permutation of the axes
  return even == (f.towards_centre < 0);
}

std::array<LatticePoint, 8> bcc_children(const LatticePoint& b) {
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

LatticePoint bcc_parent(const LatticePoint& b) {
  return bcc_locate({0.5 * b[0], 0.5 * b[1], 0.5 * b[2]});  // inside its parent, never on a face of it
}

LatticePoint bcc_edge_midpoint(const LatticePoint& b, int edge) {
  const BccFrame f(b);
  if (edge < 2) return shifted(b, f.p, edge == 0 ? -f.towards_centre : f.towards_centre);
  const auto& ends = kTetEdges[static_cast<std::size_t>(edge)];
  return shifted(shifted(b, f.q, ends[0] == 0 ? -1 : 1), f.r, ends[1] == 2 ? -1 : 1);
}

int bcc_edge_at(const LatticePoint& b, const LatticePoint& m) {
  const BccFrame f(b);
  if (m[f.p] != b[f.p]) return m[f.p] - b[f.p] == f.towards_centre ? 1 : 0;
  return 2 + (m[f.q] > b[f.q] ? 2 : 0) + (m[f.r] > b[f.r] ? 1 : 0);
}

BccRing bcc_tets_around(const LatticePoint& m) {
  BccRing ring;
  const auto add = [&](const LatticePoint& b) { ring.barycentre[static_cast<std::size_t>(ring.count++)] = b; };
  if ((m[0] & 1) == 0) {  // long edge, along the axis whose coordinate differs from the other two modulo 4
    const std::size_t along = (m[0] & 3) == (m[1] & 3) ? 2 : (m[0] & 3) == (m[2] & 3) ? 1 : 0;
    for (std::size_t side = 1; side < 3; ++side) {
      for (const int step : {-1, 1}) add(shifted(m, (along + side) % 3, step));
    }
    return ring;
  }
  LatticePoint corner;
  for (std::size_t a = 0; a < 3; ++a) corner[a] = (m[a] & 3) == 1 ? m[a] - 1 : m[a] + 1;
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t side = 1; side < 3; ++side) {
      const std::size_t q = (p + side) % 3;
      LatticePoint b = corner;
      b[p] = m[p];
      b[q] += 2 * (m[q] - corner[q]);
      add(b);
    }
  }
  return ring;
}

int bcc_local_index(const LatticePoint& b) {
  const BccFrame f(b);
  return static_cast<int>(f.p) * 4 + ((b[f.p] & 3) == 3 ? 2 : 0) + ((f.p + 1) % 3 == f.q ? 0 : 1);
}

LatticePoint bcc_from_local(const LatticePoint& cell, int local) {
  const std::size_t p = static_cast<std::size_t>(local) / 4;
  LatticePoint b = {4 * cell[0], 4 * cell[1], 4 * cell[2]};
  b[p] += (local & 2) ? 3 : 1;
  b[(p + ((local & 1) ? 2 : 1)) % 3] += 2;
  return b;
}

LatticePoint bcc_locate(Vec3 x) {
  LatticePoint centre;
  Vec3 d;
  for (std::size_t a = 0; a < 3; ++a) {
    centre[a] = 4 * static_cast<std::int32_t>(std::floor(x[a] / 4)) + 2;
    d[a] = x[a] - centre[a];
  }
  // The tetrahedron lies around the edge from this cube's centre through its nearest face (axis r), on the side
  // of the nearest of that face's edges (axis p).
  std::array<std::size_t, 3> axis = {0, 1, 2};
  const auto order = [&](std::size_t first, std::size_t second) {
    if (std::abs(d[axis[second]]) > std::abs(d[axis[first]])) std::swap(axis[first], axis[second]);
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  LatticePoint b = centre;
  b[axis[0]] += d[axis[0]] < 0 ? -2 : 2;
  b[axis[1]] += d[axis[1]] < 0 ? -1 : 1;
  return b;
}

int bcc_child_at(const LatticePoint& b, const BccFrame& frame, Vec3 x) {
  const LocalOffset d(b, frame, x);
  if (d.q <= -(1 + d.p)) return 0;
  if (d.q >= 1 + d.p) return 1;
  if (d.r <= -(1 - d.p)) return 2;
  if (d.r >= 1 - d.p) return 3;
  if (std::abs(d.q) >= std::abs(d.r)) return d.q < 0 ? 4 : 5;
  return d.r < 0 ? 6 : 7;
}

std::array<double, 4> bcc_barycentric_times_4(const LatticePoint& b, Vec3 x) {
  const LocalOffset d(b, BccFrame(b), x);
  return {1 - d.p - d.q, 1 - d.p + d.q, 1 + d.p - d.r, 1 + d.p + d.r};
}

}  // namespace anatomesh
