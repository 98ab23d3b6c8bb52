#include "mesh/star_slack.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "base/vector_clones.h"

namespace anatomesh {
namespace {

// The bounds, as the kernel takes them.
template <class Real>
struct Limits {
  Real largest_cos, smallest_cos, ratio3, per_ratio3, cushion_ratio3;

  explicit Limits(const ShapeBounds& bounds)
      : largest_cos(static_cast<Real>(bounds.largest_cos)),
        smallest_cos(static_cast<Real>(bounds.smallest_cos)),
        ratio3(cube(bounds.min_mean_ratio)),
        per_ratio3(static_cast<Real>(1 / (3 * bounds.min_mean_ratio * bounds.min_mean_ratio))),
        cushion_ratio3(cube(kCushionBounds.min_mean_ratio)) {}

 private:
  static Real cube(double x) { return static_cast<Real>(x * x * x); }
};

// Without a branch, so that the compiler makes vector instructions of it. The normals of the faces opposite to b, c and
// d are those of TetGeometry.
template <class Real>
[[gnu::always_inline]] inline void slack_of_block(const StarSlack::Block<Real>& block, const Limits<Real>& limits,
                                                  Real px, Real py, Real pz, Real* __restrict slack) {
  for (std::size_t n = 0; n < StarSlack::kLanes; ++n) {
    const Real bx = block.bx[n] - px, by = block.by[n] - py, bz = block.bz[n] - pz;
    const Real cx = block.cx[n] - px, cy = block.cy[n] - py, cz = block.cz[n] - pz;
    const Real dx = block.dx[n] - px, dy = block.dy[n] - py, dz = block.dz[n] - pz;
    const Real nax = block.nx[n], nay = block.ny[n], naz = block.nz[n];
    Real nbx = dy * cz - dz * cy, nby = dz * cx - dx * cz, nbz = dx * cy - dy * cx;
    Real ncx = by * dz - bz * dy, ncy = bz * dx - bx * dz, ncz = bx * dy - by * dx;
    Real ndx = cy * bz - cz * by, ndy = cz * bx - cx * bz, ndz = cx * by - cy * bx;
    const Real pb = 1 / std::sqrt(nbx * nbx + nby * nby + nbz * nbz);
    const Real pc = 1 / std::sqrt(ncx * ncx + ncy * ncy + ncz * ncz);
    const Real pd = 1 / std::sqrt(ndx * ndx + ndy * ndy + ndz * ndz);
    nbx *= pb, nby *= pb, nbz *= pb;
    ncx *= pc, ncy *= pc, ncz *= pc;
    ndx *= pd, ndy *= pd, ndz *= pd;
    const Real ab = -(nax * nbx + nay * nby + naz * nbz), ac = -(nax * ncx + nay * ncy + naz * ncz);
    const Real ad = -(nax * ndx + nay * ndy + naz * ndz), bc = -(nbx * ncx + nby * ncy + nbz * ncz);
    const Real bd = -(nbx * ndx + nby * ndy + nbz * ndz), cd = -(ncx * ndx + ncy * ndy + ncz * ndz);
    const Real largest = std::max(std::max(std::max(ab, ac), std::max(ad, bc)), std::max(bd, cd));
    const Real smallest = std::min(std::min(std::min(ab, ac), std::min(ad, bc)), std::min(bd, cd));
    const Real volume6 = block.area2[n] * (nax * bx + nay * by + naz * bz);
    const Real edges =
        block.edges[n] + (bx * bx + by * by + bz * bz) + (cx * cx + cy * cy + cz * cz) + (dx * dx + dy * dy + dz * dz);
    const Real ratio3 = 432 * volume6 * volume6 / (edges * edges * edges);
    const Real angles = std::min(limits.largest_cos - largest, smallest - limits.smallest_cos);
    // In this order: a degenerate face makes the angles NaN, and then the mean ratio is what counts.
    const Real of_tissue = std::min((ratio3 - limits.ratio3) * limits.per_ratio3, angles);
    const Real of_cushion = ratio3 >= limits.cushion_ratio3 ? Real{1} : Real{-1};
    const Real inside = block.cushion[n] != 0 ? of_cushion : of_tissue;
    slack[n] = volume6 > 0 ? inside : Real{-1};
  }
}

// What depends on the faces opposite to the vertex only.
template <class Real>
[[gnu::always_inline]] inline void measure_faces(StarSlack::Block<Real>& block) {
  for (std::size_t n = 0; n < StarSlack::kLanes; ++n) {
    const Real cx = block.cx[n] - block.bx[n], cy = block.cy[n] - block.by[n], cz = block.cz[n] - block.bz[n];
    const Real dx = block.dx[n] - block.bx[n], dy = block.dy[n] - block.by[n], dz = block.dz[n] - block.bz[n];
    const Real ex = dx - cx, ey = dy - cy, ez = dz - cz;
    const Real nx = cy * dz - cz * dy, ny = cz * dx - cx * dz, nz = cx * dy - cy * dx;
    const Real area2 = std::sqrt(nx * nx + ny * ny + nz * nz);
    const Real per_area2 = 1 / area2;
    block.nx[n] = per_area2 * nx;
    block.ny[n] = per_area2 * ny;
    block.nz[n] = per_area2 * nz;
    block.area2[n] = area2;
    block.edges[n] = (cx * cx + cy * cy + cz * cz) + (dx * dx + dy * dy + dz * dz) + (ex * ex + ey * ey + ez * ez);
  }
}

// Templates have no clones: these are what has them.
ANATOMESH_VECTOR_CLONES void slack_of(const StarSlack::Block<double>& block, const Limits<double>& limits, double px,
                                      double py, double pz, double* __restrict slack) {
  slack_of_block(block, limits, px, py, pz, slack);
}

ANATOMESH_VECTOR_CLONES void slack_of(const StarSlack::Block<float>& block, const Limits<float>& limits, float px,
                                      float py, float pz, float* __restrict slack) {
  slack_of_block(block, limits, px, py, pz, slack);
}

ANATOMESH_VECTOR_CLONES void measure(StarSlack::Block<double>& block) { measure_faces(block); }
ANATOMESH_VECTOR_CLONES void measure(StarSlack::Block<float>& block) { measure_faces(block); }

template <class Real>
void set(StarSlack::Block<Real>& block, std::size_t lane, Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  const auto real = [](double x) { return static_cast<Real>(x); };
  block.bx[lane] = real(b.x), block.by[lane] = real(b.y), block.bz[lane] = real(b.z);
  block.cx[lane] = real(c.x), block.cy[lane] = real(c.y), block.cz[lane] = real(c.z);
  block.dx[lane] = real(d.x), block.dy[lane] = real(d.y), block.dz[lane] = real(d.z);
  block.cushion[lane] = is_cushion ? Real{1} : Real{0};
}

template <class Real>
void append(std::vector<StarSlack::Block<Real>>& blocks, std::size_t count, Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  const std::size_t block = count / StarSlack::kLanes, lane = count % StarSlack::kLanes;
  if (lane == 0 && blocks.size() <= block) blocks.emplace_back();
  set(blocks[block], lane, b, c, d, is_cushion);
}

// The last block is filled up with its first tetrahedron.
template <class Real>
void fill_up(std::vector<StarSlack::Block<Real>>& blocks, std::size_t count) {
  constexpr std::size_t kLanes = StarSlack::kLanes;
  if (const std::size_t used = count % kLanes; used != 0) {
    StarSlack::Block<Real>& last = blocks[count / kLanes];
    const Vec3 b = {last.bx[0], last.by[0], last.bz[0]}, c = {last.cx[0], last.cy[0], last.cz[0]},
               d = {last.dx[0], last.dy[0], last.dz[0]};
    for (std::size_t lane = used; lane < kLanes; ++lane) set(last, lane, b, c, d, last.cushion[0] != 0);
  }
  for (std::size_t n = 0; n < (count + kLanes - 1) / kLanes; ++n) measure(blocks[n]);
}

}  // namespace

void StarSlack::start(const ShapeBounds& bounds, Vec3 origin) {
  bounds_ = bounds;
  origin_ = origin;
  is_single_ = bounds.min_mean_ratio >= kSingleRatio;
  count_ = 0;
}

void StarSlack::add(Vec3 b, Vec3 c, Vec3 d, bool is_cushion) {
  if (is_single_) {
    append(singles_, count_, b - origin_, c - origin_, d - origin_, is_cushion);
  } else {
    append(doubles_, count_, b - origin_, c - origin_, d - origin_, is_cushion);
  }
  ++count_;
}

void StarSlack::close() {
  first_ = 0;
  if (is_single_) {
    fill_up(singles_, count_);
  } else {
    fill_up(doubles_, count_);
  }
}

double StarSlack::at(Vec3 p, double enough) const {
  if (count_ == 0) return 1;
  return is_single_ ? least_slack(singles_, p, enough + kRounding) - kRounding : least_slack(doubles_, p, enough);
}

template <class Real>
double StarSlack::least_slack(const std::vector<Block<Real>>& blocks, Vec3 p, double enough) const {
  const Limits<Real> limits(bounds_);
  const Vec3 q = p - origin_;
  const auto x = static_cast<Real>(q.x), y = static_cast<Real>(q.y), z = static_cast<Real>(q.z);
  const std::size_t used = (count_ + kLanes - 1) / kLanes, first = first_;
  Real least = 1;
  const auto look_at = [&](std::size_t n) {
    alignas(64) Real slack[kLanes];
    slack_of(blocks[n], limits, x, y, z, slack);
    const Real worst = *std::min_element(slack, slack + kLanes);
    if (!(worst < least)) return;
    least = worst;
    first_ = n;
  };
  look_at(first);
  for (std::size_t n = 0; n < used && least >= enough; ++n) {
    if (n != first) look_at(n);
  }
  return static_cast<double>(least);
}

}  // namespace anatomesh
