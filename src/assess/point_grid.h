// Points sorted into the cells of a uniform grid, to find those near a place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomesh/types.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {

class PointGrid {
 public:
  /// A grid of about as many cells as points. points must outlive the grid; ids: those of them that it holds.
  PointGrid(std::span<const Vec3> points, std::vector<VertexId> ids);

  /// Length of the box's longest side.
  double extent() const { return std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z}); }

  /// Calls visit(id) for every point within the radius of the place.
  template <class Visit>
  void within(Vec3 place, double radius, const Visit& visit) const {
    const Vec3 reach = {radius, radius, radius};
    const auto low = cell_of(place - reach), high = cell_of(place + reach);
    for (std::size_t k = low[2]; k <= high[2]; ++k) {
      for (std::size_t j = low[1]; j <= high[1]; ++j) {
        const std::size_t row = size_[0] * (j + size_[1] * k);
        for (std::size_t n = first_[row + low[0]]; n < first_[row + high[0] + 1]; ++n) {
          if (norm_squared(points_[ids_[n]] - place) <= radius * radius) visit(ids_[n]);
        }
      }
    }
  }

 private:
  std::array<std::size_t, 3> cell_of(Vec3 place) const;  // clamped to the grid

  std::span<const Vec3> points_;
  Vec3 low_, high_;
  double cell_ = 1;
  std::array<std::size_t, 3> size_ = {1, 1, 1};
  std::vector<std::size_t> first_;
  std::vector<VertexId> ids_;  // by cell
};

}  // namespace anatomesh::assess_detail
