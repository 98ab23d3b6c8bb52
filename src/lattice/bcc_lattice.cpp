#include "lattice/bcc_lattice.h"

#include <cmath>
#include <utility>

namespace anatomesh {
namespace {

// The tetrahedron that holds a point of a lattice cube, d away from the cube's centre (in any unit). It lies around the
// edge from this cube's centre through its nearest face (axis r), on the side of the nearest of that face's edges
// (axis p).
template <class Number>
LatticePoint locate_in_cube(LatticePoint centre, const std::array<Number, 3>& d) {
  std::array<std::size_t, 3> axis = {0, 1, 2};
  const auto order = [&](std::size_t first, std::size_t second) {
    if (std::abs(d[axis[second]]) > std::abs(d[axis[first]])) std::swap(axis[first], axis[second]);
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  centre[axis[0]] += d[axis[0]] < 0 ? -2 : 2;
  centre[axis[1]] += d[axis[1]] < 0 ? -1 : 1;
  return centre;
}

}  // namespace

bool is_bcc_barycentre(const LatticePoint& b) {
  std::array<int, 4> seen = {0, 0, 0, 0};
  for (const std::int32_t c : b) ++seen[static_cast<std::size_t>(c & 3)];
  return seen[0] == 1 && seen[2] == 1;
}

// Inside its parent, never on a face of it.
LatticePoint bcc_parent(const LatticePoint& b) {
  LatticePoint centre, twice_off;
  for (std::size_t a = 0; a < 3; ++a) {
    centre[a] = 4 * (b[a] >> 3) + 2;
    twice_off[a] = b[a] - 2 * centre[a];
  }
  return locate_in_cube(centre, twice_off);
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

LatticePoint bcc_locate(Vec3 x) {
  LatticePoint centre;
  std::array<double, 3> off;
  for (std::size_t a = 0; a < 3; ++a) {
    centre[a] = 4 * static_cast<std::int32_t>(std::floor(x[a] / 4)) + 2;
    off[a] = x[a] - centre[a];
  }
  return locate_in_cube(centre, off);
}

}  // namespace anatomesh
