#include "boundary/interface_level.h"

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace anatomesh {
namespace {

// Solves the symmetric positive definite system A x = b.
Vec3 solve_symmetric(const Mat3& a, Vec3 b) {
  const Vec3 c0 = {a[0][0], a[1][0], a[2][0]}, c1 = {a[0][1], a[1][1], a[2][1]}, c2 = {a[0][2], a[1][2], a[2][2]};
  const double det = dot(c0, cross(c1, c2));
  return (1 / det) * Vec3{dot(b, cross(c1, c2)), dot(c0, cross(b, c2)), dot(c0, cross(c1, b))};
}

double trace_of(const Mat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

Mat3 damped(Mat3 normal) {
  const double trace = trace_of(normal);
  for (std::size_t r = 0; r < 3; ++r) normal[r][r] += 0.01 * trace;
  return normal;
}

}  // namespace

bool on_image_border(const TissueImage& image, Vec3 p) {
  constexpr double kOnPlane = 1e-6;  // of a voxel
  for (std::size_t a = 0; a < 3; ++a) {
    const double near = kOnPlane * image.spacing_mm[a];
    if (std::abs(p[a] - image.low_border_mm(a)) < near || std::abs(p[a] - image.high_border_mm(a)) < near) return true;
  }
  return false;
}

double distance_from_boundary(const SurfaceField& field, Vec3 p, TissueId a, TissueId b) {
  if ((a == 0 || b == 0) && on_image_border(field.image(), p)) return 0;
  const auto [difference, gradient] = field.difference(p, a, b);
  constexpr double kFlat = 1e-3;  // per mm; far from both
  return std::abs(difference) / std::max(kFlat, norm(gradient));
}

InterfaceLevel::InterfaceLevel(const SurfaceField& field, Vec3 p, std::span<const TissueId> tissues)
    : field_(field), tissues_{}, count_(std::min(tissues.size(), kMaxTissues)), wanted_{} {
  std::copy_n(tissues.begin(), count_, tissues_.begin());
  std::array<Vec3, kMaxTissues> gradients;
  wanted_ = deviations(p, gradients);
}

InterfaceLevel::Shares InterfaceLevel::deviations(Vec3 q, std::array<Vec3, kMaxTissues>& gradients) const {
  Shares shares{};
  field_.evaluate(q, std::span(tissues_).first(count_), std::span(shares).first(count_),
                  std::span(gradients).first(count_));
  double mean_share = 0;
  Vec3 mean_gradient;
  for (std::size_t n = 0; n < count_; ++n) {
    mean_share += shares[n] / static_cast<double>(count_);
    mean_gradient += (1.0 / static_cast<double>(count_)) * gradients[n];
  }
  for (std::size_t n = 0; n < count_; ++n) {
    shares[n] -= mean_share;
    gradients[n] = gradients[n] - mean_gradient;
  }
  return shares;
}

std::optional<Mat3> InterfaceLevel::normal_matrix(const std::array<Vec3, kMaxTissues>& gradients) const {
  Mat3 normal = {};
  for (std::size_t n = 0; n < count_; ++n) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) normal[r][c] += gradients[n][r] * gradients[n][c];
    }
  }
  const Vec3 spacing = field_.image().spacing_mm;
  const double voxel = std::max({spacing.x, spacing.y, spacing.z});
  if (trace_of(normal) * voxel * voxel < 1e-6) return std::nullopt;
  return normal;
}

// Damped Gauss-Newton step on the deviations.
Vec3 InterfaceLevel::step_from(Vec3 q) const {
  std::array<Vec3, kMaxTissues> gradients;
  const Shares at = deviations(q, gradients);
  const std::optional<Mat3> normal = normal_matrix(gradients);
  if (!normal) return {};
  Vec3 rhs;
  for (std::size_t n = 0; n < count_; ++n) rhs -= (at[n] - wanted_[n]) * gradients[n];
  const Vec3 spacing = field_.image().spacing_mm;
  const Vec3 step = solve_symmetric(damped(*normal), rhs);
  const double voxels =
      std::max({std::abs(step.x) / spacing.x, std::abs(step.y) / spacing.y, std::abs(step.z) / spacing.z});
  return voxels > 0.5 ? (0.5 / voxels) * step : step;
}

Mat3 InterfaceLevel::along_at(Vec3 q) const {
  std::array<Vec3, kMaxTissues> gradients;
  deviations(q, gradients);
  Mat3 along = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const std::optional<Mat3> normal = normal_matrix(gradients);
  if (!normal) return along;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3 across = solve_symmetric(damped(*normal), {(*normal)[0][c], (*normal)[1][c], (*normal)[2][c]});
    for (std::size_t r = 0; r < 3; ++r) along[r][c] -= across[r];
  }
  return along;
}

}  // namespace anatomesh
