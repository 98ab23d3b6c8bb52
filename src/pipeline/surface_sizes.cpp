#include "pipeline/surface_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "image/boundary_area.h"

namespace anatomesh {
namespace {

// Measured on the authors' ventricles and nidus: of a tissue of volume V and area A, meshed with spacing h along its
// surface, this times (h A / V)^2 of the voxels are wrong, at first; finer surfaces gain with a lower power of h.
constexpr double kWrongShare = 0.006;
constexpr double kPower = 1.6;
// At F = 0.95, the voxels that may be wrong are at most a layer of this share of the largest voxel spacing.
constexpr double kLayer = 0.08;
// Tetrahedra of a finished mesh for each square of the spacing on an interface.
constexpr double kTetsPerSquare = 6;
// A spacing may be that much larger than asked.
constexpr double kTolerance = 1.04;
// One measurement says little about spacings farther away than this.
constexpr double kFinest = 0.4, kCoarsest = 2;
// Another lattice pays where so much of what a tissue asks for is lacking, or so much of the tetrahedra can be saved.
constexpr double kLacking = 1.15, kSaving = 0.4;
// A tissue that still has this share of its wrong voxels after one correction is not mended by another.
constexpr double kGains = 0.85;
constexpr int kRootsToTry = 6;  // to each halving

int level_for(double root_mm, double size_mm, int most) {
  const double level = std::ceil(std::log2(root_mm / (kTolerance * size_mm)));
  return level < most ? std::max(0, static_cast<int>(level)) : most;
}

int most_levels(double root_mm, double smallest_mm) {
  constexpr double kMost = 16;  // far more than coordinates allow
  return static_cast<int>(std::clamp(std::floor(std::log2(root_mm / smallest_mm) + 1e-9), 0.0, kMost));
}

}  // namespace

void set_root(LatticePlan& plan, const TissueImage& image, double root_mm, double smallest_mm) {
  plan.bcc_size_mm = root_mm;
  plan.levels = most_levels(root_mm, smallest_mm);
  // Deep enough for a tissue of one voxel: tetrahedra a quarter as wide as the thinnest side of it.
  const double thinnest = std::min({image.spacing_mm.x, image.spacing_mm.y, image.spacing_mm.z});
  const double smallest = std::ldexp(root_mm, -plan.levels);
  plan.extra_levels = static_cast<int>(std::clamp(std::ceil(std::log2(4 * smallest / thinnest)), 0.0, 8.0));
}

double spacing_for(double wrong) { return std::sqrt(wrong / kWrongShare); }

double wrong_layer_mm(const TissueImage& image, double wrong) {
  return wrong / 0.05 * kLayer * std::max({image.spacing_mm.x, image.spacing_mm.y, image.spacing_mm.z});
}

SurfaceSizes::SurfaceSizes(const TissueImage& image, const Range& range, std::span<const double> wanted)
    : image_(image),
      range_(range),
      area_mm2_(boundary_areas_mm2(image)),
      wrong_(wanted.size(), 0),
      size_mm_(wanted.size(), 0),
      last_wrong_(wanted.size(), std::numeric_limits<double>::infinity()) {
  for (std::size_t t = 1; t < wanted.size(); ++t) {
    wrong_[t] = 1 - wanted[t];
    size_mm_[t] = spacing_for(wrong_[t]) * image.volume_mm3(t) / area_mm2_[t];
  }
}

void SurfaceSizes::fit_budget(double tets) {
  // The sum of (h A / V)^2 is least, where that of A / h^2 is given, with h^4 proportional to V^2 / A.
  std::vector<double> fair(size_mm_.size(), 0);
  double squares = 0, twice = 0;
  for (std::size_t t = 1; t < fair.size(); ++t) {
    fair[t] = std::sqrt(image_.volume_mm3(t) / std::sqrt(area_mm2_[t]));
    squares += area_mm2_[t] / (fair[t] * fair[t]);
    twice += area_mm2_[t];
  }
  // A lattice has them in halvings only, and changes of spacing cost tetrahedra and smoothness: what is less than a
  // halving from the usual one becomes the usual one.
  const double usual = std::sqrt(twice / squares);
  squares = 0;
  for (std::size_t t = 1; t < fair.size(); ++t) {
    fair[t] = usual * std::exp2(-std::trunc(std::log2(usual / fair[t])));
    squares += area_mm2_[t] / (fair[t] * fair[t]);
  }
  squares *= 0.5 * (1 + area_mm2_[0] / twice);  // an interface between two tissues counted for both
  const double factor = std::sqrt(kTetsPerSquare * squares / tets);
  for (std::size_t t = 1; t < fair.size(); ++t) size_mm_[t] = std::max(size_mm_[t], factor * fair[t]);
}

void SurfaceSizes::scale(double factor) {
  for (double& size : size_mm_) size *= factor;
}

// Proportional to the number of tetrahedra.
double SurfaceSizes::cost(const Choice& choice) const {
  double sum = 0;
  for (std::size_t t = 1; t < area_mm2_.size(); ++t) {
    const double size = std::ldexp(choice.root_mm, -choice.surface_level[t]);
    sum += area_mm2_[t] / (size * size);
  }
  return sum;
}

SurfaceSizes::Choice SurfaceSizes::choose() const {
  Choice best;
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0;; ++n) {
    Choice choice;
    choice.root_mm = range_.largest_root_mm * std::exp2(-static_cast<double>(n) / kRootsToTry);
    if (n > 0 && choice.root_mm <= range_.smallest_root_mm * (1 + 1e-9)) return best;
    choice.levels = most_levels(choice.root_mm, range_.smallest_mm);
    choice.surface_level.assign(size_mm_.size(), 0);
    for (std::size_t t = 1; t < size_mm_.size(); ++t)
      choice.surface_level[t] = level_for(choice.root_mm, size_mm_[t], choice.levels);
    if (cost(choice) >= least) continue;
    least = cost(choice);
    best = std::move(choice);
  }
}

bool SurfaceSizes::correct(const Choice& used, std::span<const Fidelity> reached) {
  const std::vector<double> before = size_mm_;
  bool lacks = false;
  for (std::size_t t = 1; t < size_mm_.size(); ++t) {
    const double wrong = std::max(1e-6, 1 - std::min(reached[t].f1(), reached[t].f2()));
    const double size = std::ldexp(used.root_mm, -used.surface_level[t]);
    const bool gains = wrong < kGains * last_wrong_[t] && used.surface_level[t] < used.levels;
    lacks = lacks || (gains && wrong > kLacking * wrong_[t]);
    last_wrong_[t] = wrong;
    size_mm_[t] = size * std::clamp(std::pow(wrong_[t] / wrong, 1 / kPower), kFinest, kCoarsest);
  }
  if (cost(choose()) < kSaving * cost(used)) return true;
  for (std::size_t t = 1; t < size_mm_.size(); ++t) size_mm_[t] = std::min(size_mm_[t], before[t]);
  return lacks;
}

}  // namespace anatomesh
