// A hash map from tetrahedra to what a search knows of them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "anatomesh/types.h"

namespace anatomesh {

/// Open addressing with linear probing. Clearing it takes as long as filling it took, whatever it has held before.
template <class Value>
class TetMap {
 public:
  /// What is known of a tetrahedron; a new Value where nothing is. Good until the next call.
  Value& operator[](TetId t) {
    if (2 * (used_.size() + 1) > slots_.size()) grow();
    const std::size_t at = find(t);
    if (slots_[at].tet == kNobody) {
      slots_[at] = {t, Value{}};
      used_.push_back(at);
    }
    return slots_[at].value;
  }

  std::size_t size() const { return used_.size(); }

  /// Calls visit(tetrahedron) for each that something is known of.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const std::size_t at : used_) visit(slots_[at].tet);
  }

  void clear() {
    for (const std::size_t at : used_) slots_[at].tet = kNobody;
    used_.clear();
  }

 private:
  static constexpr TetId kNobody = ~TetId{0};
  struct Slot {
    TetId tet = kNobody;
    Value value{};
  };

  std::size_t find(TetId t) const {
    std::size_t at = (t * std::size_t{0x9e3779b97f4a7c15} >> 20u) & (slots_.size() - 1);
    while (slots_[at].tet != t && slots_[at].tet != kNobody) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(slots_.empty() ? 256 : 2 * slots_.size()));
    for (std::size_t& at : used_) {
      const Slot& slot = old[at];
      at = find(slot.tet);
      slots_[at] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::vector<std::size_t> used_;
};

}  // namespace anatomesh
