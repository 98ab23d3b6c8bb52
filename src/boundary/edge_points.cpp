// Edge points by J. Canny, "A computational approach to edge detection", IEEE Transactions on Pattern Analysis and
// Machine Intelligence 8(6), 1986: smoothing, gradient, suppression of non-maxima along the gradient, hysteresis.
// Y. Liu, P. Foteinos, A. Chernikov, N. Chrisochoides, "Mesh deformation-based multi-tissue mesh generation for
// brain images", Engineering with Computers 28(4), 2012, takes them as the targets of the mesh's boundary.
//
// Departures, all because the input is a label image:
// - Tissues a and b have a field of their own, phi = u_a - u_b (LabelField), so that label values do not matter.
// - Only where voxels of a and b share a face can there be an edge of the pair. From every such face the maximum of
//   the gradient is walked to along the gradient, instead of suppressing the non-maxima of all voxels; no face
//   loses its edge this way, and no pair either.
// - Hysteresis has nothing to do: every edge is a step of full height, hence strong.
// - The maximum of the gradient finds the edge; its place is then refined to phi = 0 if that is within half a voxel.
//   On a curved or thin tissue the maximum of the gradient lies outward of the boundary (by a sixth of a voxel on
//   a sheet one voxel thick), while phi = 0 keeps the volume.
#include "boundary/edge_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "anatomesh/errors.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "boundary/label_field.h"

namespace anatomesh {
namespace {

// Two voxels that share a face: the second is one step along `axis` from the first.
struct VoxelFace {
  std::array<int, 3> voxel;
  std::size_t axis;
};

struct Candidate {
  EdgePoint point;
  double moved;  // squared distance in voxels from the centre of the face where it started

  std::size_t offset(const TissueImage& image) const {
    return image.offset(point.voxel[0], point.voxel[1], point.voxel[2]);
  }
};

// phi = u_low - u_high along the line origin + s * direction.
class Profile {
 public:
  struct Sample {
    double value, slope;
  };

  Profile(const LabelField& field, TissuePair pair, Vec3 origin) : field_(field), pair_{pair.low, pair.high} {
    origin_ = origin;
    direction_ = gradient_at(origin, at_origin_.value);
    const double length = norm(direction_);
    at_origin_.slope = length;
    direction_ = length > 0 ? (1 / length) * direction_ : Vec3{};
  }

  Sample at_origin() const { return at_origin_; }
  Vec3 direction() const { return direction_; }
  Vec3 point(double s) const { return origin_ + s * direction_; }
  Sample at(double s) const {
    Sample sample;
    sample.slope = dot(gradient_at(point(s), sample.value), direction_);
    return sample;
  }

 private:
  Vec3 gradient_at(Vec3 p, double& phi) const {
    std::array<double, 2> u;
    std::array<Vec3, 2> du;
    field_.evaluate(p, pair_, u, du);
    phi = u[0] - u[1];
    return du[0] - du[1];
  }

  const LabelField& field_;
  std::array<TissueId, 2> pair_;
  Vec3 origin_, direction_;
  Sample at_origin_{};
};

// Length in mm of the way along the unit vector n through one voxel.
double voxel_length(Vec3 n, Vec3 spacing) { return 1 / norm({n.x / spacing.x, n.y / spacing.y, n.z / spacing.z}); }

// How far from the centre of its face an edge may be, in steps of one voxel: to the maximum, and on from there.
constexpr double kToMaximum = 0.75, kToLevel = 0.5;

// Where the slope is largest: the vertex of the parabola through three samples half a step apart.
double steepest(const Profile& profile, double step) {
  const double before = profile.at(-0.5 * step).slope, here = profile.at_origin().slope;
  const double after = profile.at(0.5 * step).slope;
  const double bend = before - 2 * here + after;
  if (bend >= 0) return 0;  // no maximum near: the face itself is the edge
  return std::clamp(0.25 * step * (before - after) / bend, -kToMaximum * step, kToMaximum * step);
}

// The zero of phi near `start`, or `start` if there is none.
double settle_on_level(const Profile& profile, double start, double step) {
  constexpr int kNewtonSteps = 2;  // the profile is nearly straight here: the second changes it by 1e-3 voxels
  double s = start;
  for (int n = 0; n < kNewtonSteps; ++n) {
    const Profile::Sample sample = profile.at(s);
    if (sample.slope <= 0) return start;
    s -= sample.value / sample.slope;
    if (!(std::abs(s - start) <= kToLevel * step)) return start;
  }
  return s;
}

Candidate locate(const LabelField& field, const VoxelFace& face, TissuePair pair) {
  const TissueImage& image = field.image();
  Vec3 centre = image.centre_mm(face.voxel[0], face.voxel[1], face.voxel[2]);
  centre[face.axis] += 0.5 * image.spacing_mm[face.axis];
  const Profile profile(field, pair, centre);
  double s = 0;
  if (profile.direction() != Vec3{}) {
    const double step = voxel_length(profile.direction(), image.spacing_mm);
    s = settle_on_level(profile, steepest(profile, step), step);
  }

  Candidate found{{profile.point(s), pair, face.voxel}, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const double moved = (found.point.position_mm[a] - centre[a]) / image.spacing_mm[a];
    const double from_voxel = moved + (a == face.axis ? 0.5 : 0.0);
    found.point.voxel[a] += static_cast<int>(std::floor(from_voxel + 0.5));
    found.moved += moved * moved;
  }
  return found;
}

// Of the candidates of one voxel and pair keeps the one that moved least.
void keep_best_of_each_voxel(const TissueImage& image, std::vector<Candidate>& candidates) {
  const auto place = [&](const Candidate& c) { return std::pair(c.offset(image), c.point.pair); };
  std::stable_sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    return std::pair(place(a), a.moved) < std::pair(place(b), b.moved);
  });
  const auto same = [&](const Candidate& a, const Candidate& b) { return place(a) == place(b); };
  candidates.erase(std::unique(candidates.begin(), candidates.end(), same), candidates.end());
}

// Edge points of the faces between a voxel of slice k and its neighbour of higher index, along each axis.
std::vector<Candidate> candidates_of_slice(const LabelField& field, int k) {
  const TissueImage& image = field.image();
  const std::array<std::size_t, 3> stride = {1, image.offset(0, 1, 0), image.offset(0, 0, 1)};
  std::vector<Candidate> found;
  for (int j = 0; j + 1 < image.size[1]; ++j) {
    const TissueId* row = &image.voxels[image.offset(0, j, k)];
    for (int i = 0; i + 1 < image.size[0]; ++i, ++row) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const TissueId here = row[0], there = row[stride[axis]];
        if (here == there) continue;
        found.push_back(locate(field, {{i, j, k}, axis}, {std::min(here, there), std::max(here, there)}));
      }
    }
  }
  keep_best_of_each_voxel(image, found);
  return found;
}

// A point ends at most 1.25 voxels from the centre of its face, thus in slices k - 1 to k + 2 for a face of slice k.
std::vector<EdgePoint> points_of_slice(const TissueImage& image, const std::vector<std::vector<Candidate>>& by_face,
                                       int k) {
  std::vector<Candidate> here;
  for (int from = std::max(k - 2, 0); from <= std::min(k + 1, image.size[2] - 2); ++from) {
    const std::vector<Candidate>& all = by_face[static_cast<std::size_t>(from)];
    const auto below = [](const Candidate& c, int slice) { return c.point.voxel[2] < slice; };
    const auto begin = std::lower_bound(all.begin(), all.end(), k, below);
    here.insert(here.end(), begin, std::lower_bound(begin, all.end(), k + 1, below));
  }
  keep_best_of_each_voxel(image, here);
  std::vector<EdgePoint> points;
  points.reserve(here.size());
  for (const Candidate& c : here) points.push_back(c.point);
  return points;
}

}  // namespace

std::vector<EdgePoint> find_edge_points(const TissueImage& image, std::stop_token cancel) {
  // The crop's outermost voxels are background, so its last slice, rows and columns have no face of their own.
  const LabelField field(image);
  const std::size_t slices = static_cast<std::size_t>(image.size[2]);
  std::vector<std::vector<Candidate>> by_face(slices - 1);
  parallel_for(
      slices - 1,
      [&](std::size_t k) {
        if (!cancel.stop_requested()) by_face[k] = candidates_of_slice(field, static_cast<int>(k));
      },
      1);
  if (cancel.stop_requested()) throw Cancelled();

  std::vector<std::vector<EdgePoint>> by_voxel(slices);
  parallel_for(
      slices, [&](std::size_t k) { by_voxel[k] = points_of_slice(image, by_face, static_cast<int>(k)); }, 1);
  std::size_t total = 0;
  for (const auto& points : by_voxel) total += points.size();
  std::vector<EdgePoint> all;
  all.reserve(total);
  for (const auto& points : by_voxel) all.insert(all.end(), points.begin(), points.end());
  return all;
}

}  // namespace anatomesh
