#include "mesh/star_slack.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "base/vector_clones.h"

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
    // In this order: a degenerate face makes the angles NaN, and then the mean ratio is what counts.
    const double of_tissue = std::min((ratio3 - limits.ratio3) * limits.per_ratio3, angles);
    const double of_cushion = ratio3 >= limits.cushion_ratio3 ? 1.0 : -1.0;
    const double inside = block.cushion[n] != 0 ? of_cushion : of_tissue;
    slack[n] = volume6 > 0 ? inside : -1.0;
  }
}

// What depends on the faces opposite to the vertex only.
ANATOMESH_VECTOR_CLONES void measure_faces(StarSlack::Block& block) {
  for (std::size_t n = 0; n < StarSlack::kLanes; ++n) {
    const double cx = block.cx[n] - block.bx[n], cy = block.cy[n] - block.by[n], cz = block.cz[n] - block.bz[n];
    const double dx = block.dx[n] - block.bx[n], dy = block.dy[n] - block.by[n], dz = block.dz[n] - block.bz[n];
    const double ex = dx - cx, ey = dy - cy, ez = dz - cz;
    const double nx = cy * dz - cz * dy, ny = cz * dx - cx * dz, nz = cx * dy - cy * dx;
    const double area2 = std::sqrt(nx * nx + ny * ny + nz * nz);
    const double per_area2 = 1 / area2;
    block.nx[n] = per_area2 * nx;
    block.ny[n] = per_area2 * ny;
    block.nz[n] = per_area2 * nz;
    block.area2[n] = area2;
    block.edges[n] = (cx * cx + cy * cy + cz * cz) + (dx * dx + dy * dy + dz * dz) + (ex * ex + ey * ey + ez * ez);
  }
}

void set(StarSlack::Block& block, std::size_t lane, Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  block.bx[lane] = b.x, block.by[lane] = b.y, block.bz[lane] = b.z;
  block.cx[lane] = c.x, block.cy[lane] = c.y, block.cz[lane] = c.z;
  block.dx[lane] = d.x, block.dy[lane] = d.y, block.dz[lane] = d.z;
  block.cushion[lane] = is_cushion ? 1 : 0;
}

}  // namespace

void StarSlack::add(Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  const std::size_t n = count_ % kLanes;
  if (n == 0 && blocks_.size() <= count_ / kLanes) blocks_.emplace_back();
  set(blocks_[count_ / kLanes], n, b, c, d, is_cushion);
  ++count_;
}

// The last block is filled up with its first tetrahedron.
void StarSlack::close() {
  first_ = 0;
  if (const std::size_t used = count_ % kLanes; used != 0) {
    Block& last = blocks_[count_ / kLanes];
    const Vec3 b = {last.bx[0], last.by[0], last.bz[0]}, c = {last.cx[0], last.cy[0], last.cz[0]},
               d = {last.dx[0], last.dy[0], last.dz[0]};
    for (std::size_t lane = used; lane < kLanes; ++lane) set(last, lane, b, c, d, last.cushion[0] != 0);
  }
  for (std::size_t n = 0; n < (count_ + kLanes - 1) / kLanes; ++n) measure_faces(blocks_[n]);
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
