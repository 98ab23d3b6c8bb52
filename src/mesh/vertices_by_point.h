// Vertices found by their coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "anatomesh/types.h"

namespace anatomesh {

/// Which vertex lies exactly at a point.
class VerticesByPoint {
 public:
  /// Of several vertices at one point the first one stays.
  void add(const Vec3& p, VertexId v) { known_.emplace(p, v); }

  std::optional<VertexId> at(const Vec3& p) const {
    const auto found = known_.find(p);
    return found == known_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  struct Hash {
    std::size_t operator()(const Vec3& p) const {
      std::uint64_t h = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        std::uint64_t bits;
        const double c = p[a] + 0.0;  // -0 becomes 0
        std::memcpy(&bits, &c, sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29u;
      }
      return h;
    }
  };

  std::unordered_map<Vec3, VertexId, Hash> known_;
};

}  // namespace anatomesh
