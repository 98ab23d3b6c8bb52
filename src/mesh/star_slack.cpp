#include "mesh/star_slack.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"

// One version of a function for each kind of vector instructions; the loader takes the best that the processor has.
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ANATOMESH_VECTOR_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ANATOMESH_VECTOR_CLONES
#endif

namespace anatomesh {
namespace {

// The bounds, as the kernel takes them.
struct Limits {
  double largest_cos, smallest_cos, ratio3, per_ratio3, cushion_ratio3;

  explicit Limits(const ShapeBounds& bounds)
      : largest_cos(bounds.largest_cos),
        smallest_cos(bounds.smallest_cos),
        ratio3(cube(bounds.min_mean_ratio)),
        per_ratio3(1 / (3 * bounds.min_mean_ratio * bounds.min_mean_ratio)),
        cushion_ratio3(cube(kCushionBounds.min_mean_ratio)) {}

 private:
  static double cube(double x) { return x * x * x; }
};

// Without a branch, so that the compiler makes vector instructions of it. The normals of the faces opposite to b, c and
// d are those of TetGeometry.
ANATOMESH_VECTOR_CLONES void slack_of_block(const StarSlack::Block& block, const Limits& limits, double px, double py,
                                            double pz, double* __restrict slack) {
  for (std::size_t n = 0; n < StarSlack::kLanes; ++n) {
    const double bx = block.bx[n] - px, by = block.by[n] - py, bz = block.bz[n] - pz;
    const double cx = block.cx[n] - px, cy = block.cy[n] - py, cz = block.cz[n] - pz;
    const double dx = block.dx[n] - px, dy = block.dy[n] - py, dz = block.dz[n] - pz;
    const double nax = block.nx[n], nay = block.ny[n], naz = block.nz[n];
    double nbx = dy * cz - dz * cy, nby = dz * cx - dx * cz, nbz = dx * cy - dy * cx;
    double ncx = by * dz - bz * dy, ncy = bz * dx - bx * dz, ncz = bx * dy - by * dx;
    double ndx = cy * bz - cz * by, ndy = cz * bx - cx * bz, ndz = cx * by - cy * bx;
    const double pb = 1 / std::sqrt(nbx * nbx + nby * nby + nbz * nbz);
    const double pc = 1 / std::sqrt(ncx * ncx + ncy * ncy + ncz * ncz);
    const double pd = 1 / std::sqrt(ndx * ndx + ndy * ndy + ndz * ndz);
    nbx *= pb, nby *= pb, nbz *= pb;
    ncx *= pc, ncy *= pc, ncz *= pc;
    ndx *= pd, ndy *= pd, ndz *= pd;
    const double ab = -(nax * nbx + nay * nby + naz * nbz), ac = -(nax * ncx + nay * ncy + naz * ncz);
    const double ad = -(nax * ndx + nay * ndy + naz * ndz), bc = -(nbx * ncx + nby * ncy + nbz * ncz);
    const double bd = -(nbx * ndx + nby * ndy + nbz * ndz), cd = -(ncx * ndx + ncy * ndy + ncz * ndz);
    const double largest = std::max(std::max(std::max(ab, ac), std::max(ad, bc)), std::max(bd, cd));
    const double smallest = std::min(std::min(std::min(ab, ac), std::min(ad, bc)), std::min(bd, cd));
    const double volume6 = block.area2[n] * (nax * bx + nay * by + naz * bz);
    const double edges =
        block.edges[n] + (bx * bx + by * by + bz * bz) + (cx * cx + cy * cy + cz * cz) + (dx * dx + dy * dy + dz * dz);
    const double ratio3 = 432 * volume6 * volume6 / (edges * edges * edges);
    const double angles = std::min(limits.largest_cos - largest, smallest - limits.smallest_cos);
    const double of_tissue = std::min(angles, (ratio3 - limits.ratio3) * limits.per_ratio3);
    const double of_cushion = ratio3 >= limits.cushion_ratio3 ? 1.0 : -1.0;
    const double inside = block.cushion[n] != 0 ? of_cushion : of_tissue;
    slack[n] = volume6 > 0 ? inside : -1.0;
  }
}

}  // namespace

void StarSlack::add(Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  const std::size_t n = count_ % kLanes;
  if (n == 0 && blocks_.size() <= count_ / kLanes) blocks_.emplace_back();
  Block& block = blocks_[count_ / kLanes];
  const Vec3 bc = c - b, bd = d - b, normal = cross(bc, bd);
  const double area2 = norm(normal);
  const Vec3 unit = (1 / area2) * normal;
  const double edges = norm_squared(bc) + norm_squared(bd) + norm_squared(d - c);
  const auto set = [&](std::size_t lane) {
    block.bx[lane] = b.x, block.by[lane] = b.y, block.bz[lane] = b.z;
    block.cx[lane] = c.x, block.cy[lane] = c.y, block.cz[lane] = c.z;
    block.dx[lane] = d.x, block.dy[lane] = d.y, block.dz[lane] = d.z;
    block.nx[lane] = unit.x, block.ny[lane] = unit.y, block.nz[lane] = unit.z;
    block.area2[lane] = area2;
    block.edges[lane] = edges;
    block.cushion[lane] = is_cushion ? 1 : 0;
  };
  set(n);
  // The rest of a block that is begun repeats its first tetrahedron.
  if (n == 0) {
    for (std::size_t lane = 1; lane < kLanes; ++lane) set(lane);
    if (count_ == 0) first_ = 0;
  }
  ++count_;
}

double StarSlack::at(const ShapeBounds& bounds, Vec3 p, double enough) const {
  const Limits limits(bounds);
  const std::size_t blocks = (count_ + kLanes - 1) / kLanes;
  double least = 1;
  const auto look_at = [&](std::size_t n) {
    alignas(64) double slack[kLanes];
    slack_of_block(blocks_[n], limits, p.x, p.y, p.z, slack);
    const double worst = *std::min_element(slack, slack + kLanes);
    if (!(worst < least)) return;
    least = worst;
    first_ = n;
  };
  const std::size_t first = first_;
  if (blocks > 0) look_at(first);
  for (std::size_t n = 0; n < blocks && least >= enough; ++n) {
    if (n != first) look_at(n);
  }
  return least;
}

}  // namespace anatomesh
