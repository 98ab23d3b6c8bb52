// A tree of bounding boxes over items, to find those near a point. The tree is complete and has no pointers: the
// children of node i are 2 i + 1 and 2 i + 2, and each leaf holds an equal share of the items.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "anatomesh/types.h"

namespace anatomesh::assess_detail {

/// Axis-aligned box in single precision, rounded outward so that it holds what it was made of.
struct Box {
  std::array<float, 3> low, high;

  static Box empty() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  }
  void include(const Box& other);
  void include(Vec3 p);

  double distance_squared(Vec3 p) const {
    const auto outside = [](double x, float lo, float hi) {
      const double below = lo - x, above = x - hi;
      const double d = below > above ? below : above;
      return d > 0 ? d : 0;
    };
    const double dx = outside(p.x, low[0], high[0]);
    const double dy = outside(p.y, low[1], high[1]);
    const double dz = outside(p.z, low[2], high[2]);
    return dx * dx + dy * dy + dz * dz;
  }
};

class BoxTree {
 public:
  /// Cost: n log n, parallel.
  explicit BoxTree(const std::vector<Box>& boxes);

  /// The items in the order of the tree: neighbours stand together.
  const std::vector<std::uint32_t>& order() const { return order_; }

  /// Calls visit(n, reach_squared) for items order()[n] whose box is nearer to p than the reach, nearer boxes first;
  /// visit may lower the reach.
  template <class Visit>
  void nearer_than(Vec3 p, double reach_squared, const Visit& visit) const {
    if (order_.empty() || nodes_[0].distance_squared(p) >= reach_squared) return;
    std::array<std::pair<std::size_t, double>, 64> later;
    std::size_t waiting = 0;
    std::size_t node = 0;
    for (;;) {
      while (node < first_leaf_) {
        std::size_t near = 2 * node + 1, far = near + 1;
        double near_d = nodes_[near].distance_squared(p), far_d = nodes_[far].distance_squared(p);
        if (far_d < near_d) {
          std::swap(near, far);
          std::swap(near_d, far_d);
        }
        if (near_d >= reach_squared) break;
        if (far_d < reach_squared) later[waiting++] = {far, far_d};
        node = near;
      }
      if (node >= first_leaf_) visit_leaf(node - first_leaf_, reach_squared, visit);
      do {
        if (waiting == 0) return;
        --waiting;
      } while (later[waiting].second >= reach_squared);
      node = later[waiting].first;
    }
  }

 private:
  static constexpr std::size_t kLeafItems = 4;

  /// First item of leaf n; the halves of a range of items are exact shares at every depth.
  std::size_t share(std::size_t n, std::size_t depth) const { return (n * order_.size()) >> depth; }
  void sort(const std::vector<Box>& boxes, std::size_t depth, std::size_t n);

  template <class Visit>
  void visit_leaf(std::size_t leaf, double& reach_squared, const Visit& visit) const {
    for (std::size_t i = share(leaf, depth_); i < share(leaf + 1, depth_); ++i) visit(i, reach_squared);
  }

  std::vector<std::uint32_t> order_;
  std::vector<Box> nodes_;
  std::size_t depth_ = 0;
  std::size_t first_leaf_ = 0;
};

}  // namespace anatomesh::assess_detail
