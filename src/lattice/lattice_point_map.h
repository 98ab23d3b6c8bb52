// A hash map from lattice points to numbers.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "lattice/bcc_lattice.h"

namespace anatomesh {

/// Numbers lattice points 0, 1, 2, ... in the order in which they are first inserted. Coordinates are below
/// 2^20 in magnitude. Open addressing with linear probing; a few ns a look-up in the cache.
class LatticePointMap {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr std::int32_t kMaxCoordinate = 1 << 20;

  const std::vector<LatticePoint>& points() const { return points_; }

  /// The point's number, or kNone.
  std::uint32_t find(const LatticePoint& p) const {
    if (keys_.empty()) return kNone;
    const std::uint64_t key = pack(p);
    for (std::size_t i = home(key);; i = (i + 1) & (keys_.size() - 1)) {
      if (keys_[i] == key) return numbers_[i];
      if (keys_[i] == kEmpty) return kNone;
    }
  }

  /// The point's number, a new one if it has none yet.
  std::uint32_t insert(const LatticePoint& p) {
    if (2 * (points_.size() + 1) > keys_.size()) grow();
    const std::uint64_t key = pack(p);
    std::size_t i = home(key);
    for (; keys_[i] != kEmpty; i = (i + 1) & (keys_.size() - 1)) {
      if (keys_[i] == key) return numbers_[i];
    }
    keys_[i] = key;
    numbers_[i] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    return numbers_[i];
  }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  static std::uint64_t pack(const LatticePoint& p) {
    const auto part = [](std::int32_t c) { return static_cast<std::uint64_t>(c + kMaxCoordinate); };
    return part(p[0]) | part(p[1]) << 21 | part(p[2]) << 42;
  }
  // The highest bits of the product: only they depend on all coordinates.
  std::size_t home(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> shift_);
  }
  void grow() {
    const std::size_t capacity = keys_.empty() ? 1024 : 2 * keys_.size();
    shift_ = 64 - std::countr_zero(capacity);
    keys_.assign(capacity, kEmpty);
    numbers_.assign(capacity, kNone);
    for (std::uint32_t n = 0; n < points_.size(); ++n) {
      std::size_t i = home(pack(points_[n]));
      while (keys_[i] != kEmpty) i = (i + 1) & (capacity - 1);
      keys_[i] = pack(points_[n]);
      numbers_[i] = n;
    }
  }

  int shift_ = 0;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> numbers_;
  std::vector<LatticePoint> points_;
};

}  // namespace anatomesh
