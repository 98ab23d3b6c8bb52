#include "assess/point_grid.h"

namespace anatomesh::assess_detail {

PointGrid::PointGrid(std::span<const Vec3> points, std::vector<VertexId> ids) : points_(points), ids_(ids.size()) {
  if (!ids.empty()) low_ = high_ = points[ids[0]];
  for (const VertexId v : ids) {
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], points[v][a]);
      high_[a] = std::max(high_[a], points[v][a]);
    }
  }
  // A side of no length counts as one cell, and no side as more cells than there are points.
  const auto count = static_cast<double>(std::max<std::size_t>(ids.size(), 1));
  const double smallest = extent() / count;
  double volume = 1;
  for (std::size_t a = 0; a < 3; ++a) volume *= std::max(high_[a] - low_[a], smallest);
  if (volume > 0) cell_ = std::max(std::cbrt(volume / count), smallest);
  for (std::size_t a = 0; a < 3; ++a) size_[a] = static_cast<std::size_t>((high_[a] - low_[a]) / cell_) + 1;

  const auto flat = [&](VertexId v) {
    const auto c = cell_of(points[v]);
    return c[0] + size_[0] * (c[1] + size_[1] * c[2]);
  };
  first_.assign(size_[0] * size_[1] * size_[2] + 1, 0);
  for (const VertexId v : ids) ++first_[flat(v) + 1];
  for (std::size_t c = 0; c + 1 < first_.size(); ++c) first_[c + 1] += first_[c];
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for (const VertexId v : ids) ids_[next[flat(v)]++] = v;
}

std::array<std::size_t, 3> PointGrid::cell_of(Vec3 place) const {
  std::array<std::size_t, 3> cell;
  for (std::size_t a = 0; a < 3; ++a) {
    const double c = std::clamp((place[a] - low_[a]) / cell_, 0.0, static_cast<double>(size_[a] - 1));
    cell[a] = static_cast<std::size_t>(c);
  }
  return cell;
}

}  // namespace anatomesh::assess_detail
