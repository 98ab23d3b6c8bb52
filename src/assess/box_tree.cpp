#include "assess/box_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace anatomesh::assess_detail {
namespace {

float round_down(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}

float round_up(double x) { return -round_down(-x); }

float middle(const Box& box, std::size_t axis) { return box.low[axis] + box.high[axis]; }

/// Axis along which the middles of these boxes spread most.
std::size_t widest_axis(const std::vector<Box>& boxes, std::span<const std::uint32_t> items) {
  Box spread = Box::empty();
  for (const std::uint32_t i : items) {
    for (std::size_t a = 0; a < 3; ++a) {
      spread.low[a] = std::min(spread.low[a], middle(boxes[i], a));
      spread.high[a] = std::max(spread.high[a], middle(boxes[i], a));
    }
  }
  const auto width = [&](std::size_t a) { return spread.high[a] - spread.low[a]; };
  std::size_t widest = width(1) > width(0) ? 1 : 0;
  return width(2) > width(widest) ? 2 : widest;
}

}  // namespace

void Box::include(const Box& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

void Box::include(Vec3 p) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], round_down(p[a]));
    high[a] = std::max(high[a], round_up(p[a]));
  }
}

BoxTree::BoxTree(const std::vector<Box>& boxes) : order_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(order_.begin(), order_.end(), 0u);
  while ((boxes.size() >> depth_) > kLeafItems) ++depth_;
  first_leaf_ = (std::size_t{1} << depth_) - 1;
  sort(boxes, 0, 0);

  nodes_.assign(2 * first_leaf_ + 1, Box::empty());
  parallel_for(first_leaf_ + 1, [&](std::size_t leaf) {
    for (std::size_t i = share(leaf, depth_); i < share(leaf + 1, depth_); ++i) {
      nodes_[first_leaf_ + leaf].include(boxes[order_[i]]);
    }
  });
  for (std::size_t node = first_leaf_; node-- > 0;) {
    nodes_[node].include(nodes_[2 * node + 1]);
    nodes_[node].include(nodes_[2 * node + 2]);
  }
}

/// Splits the items of the n-th node of this depth between its children, and so on down to the leaves.
void BoxTree::sort(const std::vector<Box>& boxes, std::size_t depth, std::size_t n) {
  if (depth == depth_) return;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t begin = share(n, depth), end = share(n + 1, depth);
  const std::size_t axis = widest_axis(boxes, std::span(order_).subspan(begin, end - begin));
  std::nth_element(at(begin), at(share(2 * n + 1, depth + 1)), at(end), [&](std::uint32_t a, std::uint32_t b) {
    const float x = middle(boxes[a], axis), y = middle(boxes[b], axis);
    return x != y ? x < y : a < b;
  });
  constexpr std::size_t kWorthAThread = 8192;
  if (end - begin > kWorthAThread) {
    parallel_for(
        2, [&](std::size_t child) { sort(boxes, depth + 1, 2 * n + child); }, 1);
  } else {
    sort(boxes, depth + 1, 2 * n);
    sort(boxes, depth + 1, 2 * n + 1);
  }
}

}  // namespace anatomesh::assess_detail
