#include "image/local_thickness.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "anatomesh/errors.h"
#include "base/parallel.h"

namespace anatomesh {
namespace {

constexpr int kStepVoxels = 2;

// One line of voxels along an axis.
struct Line {
  std::size_t first, stride;
  int size;
  std::size_t voxel(int n) const { return first + stride * static_cast<std::size_t>(n); }
};

// Squared distances along a line: the least of those at other voxels of the run of one tissue plus the square of the
// way there, and of the way to the run's ends.
void pass_along(const TissueImage& image, const Line& line, double step, double cap2, std::vector<float>& squared,
                std::vector<float>& before) {
  before.resize(static_cast<std::size_t>(line.size));
  for (int n = 0; n < line.size; ++n) before[static_cast<std::size_t>(n)] = squared[line.voxel(n)];
  for (int n = 0; n < line.size; ++n) {
    const TissueId tissue = image.voxels[line.voxel(n)];
    if (tissue == 0) continue;
    double best = before[static_cast<std::size_t>(n)];
    for (const int side : {-1, 1}) {
      for (int k = 1;; ++k) {
        const double to_face = (k - 0.5) * step, way = k * step;
        if (to_face * to_face >= best) break;
        const int m = n + side * k;
        if (m < 0 || m >= line.size || image.voxels[line.voxel(m)] != tissue) {
          best = to_face * to_face;
          break;
        }
        best = std::min(best, before[static_cast<std::size_t>(m)] + way * way);
      }
    }
    squared[line.voxel(n)] = static_cast<float>(std::min(best, cap2));
  }
}

void for_each_line(const TissueImage& image, std::size_t axis, const std::stop_token& cancel,
                   const std::function<void(const Line&, std::vector<float>&)>& visit) {
  const auto nx = static_cast<std::size_t>(image.size[0]), ny = static_cast<std::size_t>(image.size[1]);
  const std::array<std::size_t, 3> stride = {1, nx, nx * ny};
  const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
  const auto na = static_cast<std::size_t>(image.size[a]), nb = static_cast<std::size_t>(image.size[b]);
  parallel_blocks(na * nb, 256, [&](std::size_t begin, std::size_t end) {
    if (cancel.stop_requested()) throw Cancelled();
    std::vector<float> scratch;
    for (std::size_t n = begin; n < end; ++n)
      visit({(n % na) * stride[a] + (n / na) * stride[b], stride[axis], image.size[axis]}, scratch);
  });
}

// Voxels along each axis that a ball of this radius about a voxel's centre reaches.
std::array<int, 3> reach_of(const TissueImage& image, double radius_mm) {
  std::array<int, 3> reach;
  for (std::size_t a = 0; a < 3; ++a) reach[a] = static_cast<int>(radius_mm / image.spacing_mm[a]);
  return reach;
}

// Calls visit(offset, squared distance) for the voxels whose centres lie in the ball; it stays inside the crop, as its
// tissue does.
template <class Visit>
void for_each_in_ball(const TissueImage& image, std::array<int, 3> at, double radius_mm, const Visit& visit) {
  const auto reach = reach_of(image, radius_mm);
  const Vec3 s = image.spacing_mm;
  for (int k = -reach[2]; k <= reach[2]; ++k) {
    for (int j = -reach[1]; j <= reach[1]; ++j) {
      const double jk = j * j * s.y * s.y + k * k * s.z * s.z;
      for (int i = -reach[0]; i <= reach[0]; ++i) {
        if (jk + i * i * s.x * s.x <= radius_mm * radius_mm) visit(image.offset(at[0] + i, at[1] + j, at[2] + k));
      }
    }
  }
}

// Whether no neighbour's ball holds this voxel's ball: it lies on the medial axis, or where the distance was capped.
bool is_ridge(const TissueImage& image, const std::vector<float>& distance, std::array<int, 3> at, float cap) {
  const float own = distance[image.offset(at[0], at[1], at[2])];
  const Vec3 s = image.spacing_mm;
  bool inside_cap = own >= cap;
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const float other = distance[image.offset(at[0] + i, at[1] + j, at[2] + k)];
        inside_cap = inside_cap && other >= cap;
        const double way = std::sqrt(i * i * s.x * s.x + j * j * s.y * s.y + k * k * s.z * s.z);
        if (own < cap && way > 0 && other >= own + 0.999 * way) return false;
      }
    }
  }
  return !inside_cap;
}

// Between two voxels that are equally far from the faces on either side of them the medial axis passes half a voxel
// off: the ball there is larger by that.
double half_steps_to_axis(const TissueImage& image, const std::vector<float>& distance, std::array<int, 3> at) {
  const float own = distance[image.offset(at[0], at[1], at[2])];
  const TissueId tissue = image.at(at[0], at[1], at[2]);
  // Distance `steps` voxels along an axis; 0 in other tissues.
  const auto along = [&](std::size_t axis, int steps) {
    std::array<int, 3> to = at;
    to[axis] += steps;
    return image.at_or_background(to[0], to[1], to[2]) == tissue ? distance[image.offset(to[0], to[1], to[2])] : 0.0f;
  };
  double most = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double lower = std::max(0.0, own - 0.9 * image.spacing_mm[a]);
    for (const int side : {-1, 1}) {
      const bool between = along(a, side) == own && along(a, -side) <= lower && along(a, 2 * side) <= lower;
      if (between) most = std::max(most, 0.5 * image.spacing_mm[a]);
    }
  }
  return most;
}

// The largest thickness at the voxel and its neighbours in the same tissue.
float thickest_around(const TissueImage& image, const std::vector<float>& thickness, std::array<int, 3> at) {
  const TissueId tissue = image.at(at[0], at[1], at[2]);
  float most = 0;
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        const std::size_t voxel = image.offset(at[0] + i, at[1] + j, at[2] + k);
        if (image.voxels[voxel] == tissue) most = std::max(most, thickness[voxel]);
      }
    }
  }
  return most;
}

void for_each_tissue_voxel(const TissueImage& image, const std::stop_token& cancel,
                           const std::function<void(std::array<int, 3>)>& visit) {
  parallel_for(
      static_cast<std::size_t>(image.size[2]),
      [&](std::size_t slice) {
        if (cancel.stop_requested()) throw Cancelled();
        const int k = static_cast<int>(slice);
        for (int j = 0; j < image.size[1]; ++j) {
          for (int i = 0; i < image.size[0]; ++i) {
            if (image.at(i, j, k) != 0) visit({i, j, k});
          }
        }
      },
      1);
}

}  // namespace

std::vector<float> distance_to_tissue_faces(const TissueImage& image, double cap_mm, const std::stop_token& cancel) {
  std::vector<float> squared(image.voxels.size(), 0);
  const double cap2 = cap_mm * cap_mm;
  for (std::size_t v = 0; v < squared.size(); ++v) squared[v] = image.voxels[v] == 0 ? 0 : static_cast<float>(cap2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for_each_line(image, axis, cancel, [&](const Line& line, std::vector<float>& scratch) {
      pass_along(image, line, image.spacing_mm[axis], cap2, squared, scratch);
    });
  }
  for (float& d : squared) d = std::sqrt(d);
  return squared;
}

std::vector<float> local_thickness(const TissueImage& image, double cap_mm, const std::stop_token& cancel) {
  const auto cap = static_cast<float>(0.5 * cap_mm);
  const std::vector<float> distance = distance_to_tissue_faces(image, cap, cancel);
  std::vector<float> thickness(image.voxels.size(), 0);
  // Slices write to each other's voxels; the largest of several writers stays, whatever their order.
  const auto raise = [&](std::size_t voxel, float diameter) {
    std::atomic_ref<float> at(thickness[voxel]);
    float seen = at.load(std::memory_order_relaxed);
    while (seen < diameter && !at.compare_exchange_weak(seen, diameter, std::memory_order_relaxed)) {
    }
  };
  for_each_tissue_voxel(image, cancel, [&](std::array<int, 3> at) {
    const std::size_t own = image.offset(at[0], at[1], at[2]);
    const float d = distance[own];
    raise(own, 2 * d);
    if (!is_ridge(image, distance, at, cap)) return;
    const auto diameter = static_cast<float>(2 * (d + half_steps_to_axis(image, distance, at)));
    for_each_in_ball(image, at, d, [&](std::size_t voxel) { raise(voxel, diameter); });
  });
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    const bool thick = image.voxels[v] == 0 || distance[v] >= cap || thickness[v] >= 2 * cap;
    if (thick) thickness[v] = std::numeric_limits<float>::infinity();
  }
  // The steps of a surface of voxels stick out of the balls, and are no thin part.
  std::vector<float> smooth = thickness;
  for (int pass = 0; pass < kStepVoxels; ++pass) {
    for_each_tissue_voxel(image, cancel, [&](std::array<int, 3> at) {
      smooth[image.offset(at[0], at[1], at[2])] = thickest_around(image, thickness, at);
    });
    thickness = smooth;
  }
  return thickness;
}

}  // namespace anatomesh
