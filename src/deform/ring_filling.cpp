#include "deform/ring_filling.h"

#include <algorithm>

namespace anatomesh {

double RingFilling::fill(const EdgeRing& ring, std::size_t first, std::size_t last, const ShapeBounds& bounds,
                         double enough) {
  const auto slack_of = [&](VertexId a, VertexId b, VertexId c, VertexId d) {
    return slack(bounds, mesh_.point(a), mesh_.point(b), mesh_.point(c), mesh_.point(d));
  };
  a_ = ring.a;
  b_ = ring.b;
  for (std::size_t n = first; n <= last; ++n) link_[n] = ring.link[n % ring.size];
  for (std::size_t i = first; i < last; ++i) best_[i][i + 1] = 1;
  for (std::size_t width = 2; width <= last - first; ++width) {
    for (std::size_t i = first; i + width <= last; ++i) {
      const std::size_t j = i + width;
      best_[i][j] = -2;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double wanted = std::max(enough, best_[i][j]);
        double worst = std::min(best_[i][k], best_[k][j]);
        if (worst > wanted) worst = std::min(worst, slack_of(link_[i], link_[k], link_[j], b_));
        if (worst > wanted) worst = std::min(worst, slack_of(link_[k], link_[i], link_[j], a_));
        if (worst <= wanted) continue;
        best_[i][j] = worst;
        apex_[i][j] = k;
      }
    }
  }
  return best_[first][last];
}

void RingFilling::append(std::size_t first, std::size_t last, std::vector<std::array<VertexId, 4>>& tets) const {
  if (last == first + 1) return;
  const std::size_t k = apex_[first][last];
  tets.push_back({link_[first], link_[k], link_[last], b_});
  tets.push_back({link_[k], link_[first], link_[last], a_});
  append(first, k, tets);
  append(k, last, tets);
}

}  // namespace anatomesh
