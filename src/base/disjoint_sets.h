// Union-find.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace anatomesh {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t root(std::uint32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  bool is_root(std::uint32_t x) const { return parent_[x] == x; }

  /// The smaller root stays one.
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
  }

  /// A further element, in a set of its own.
  std::uint32_t add() {
    parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
    return parent_.back();
  }

  std::uint64_t count_sets() const {
    std::uint64_t sets = 0;
    for (std::uint32_t x = 0; x < parent_.size(); ++x) sets += is_root(x);
    return sets;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace anatomesh
