#include "lattice/update_pieces.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/sort_and_unify.h"
#include "lattice/tet_map.h"

namespace anatomesh {
namespace {

constexpr std::uint32_t kNone = Pieces::kNone;

// Where more than this share of the tetrahedra has changed, all pieces are found anew.
constexpr std::size_t kMuch = 8;

// Searches from some tetrahedra of one tissue at once, a step each in turn, until they have met.
class JointSearch {
 public:
  JointSearch(const TetComplex& complex, std::span<const TetId> from)
      : complex_(complex), joined_(from.size()), groups_(from.size()), left_(from.size()) {
    for (std::uint32_t g = 0; g < from.size(); ++g) {
      group_of_[from[g]] = {g};
      groups_[g].reached.push_back(from[g]);
    }
  }

  // Calls split_off(tetrahedra) with all that hang together, for each part but the last.
  template <class SplitOff>
  void run(const SplitOff& split_off) {
    std::vector<std::uint32_t> turn(groups_.size());
    std::iota(turn.begin(), turn.end(), 0u);
    while (left_ > 1) {
      for (std::size_t i = 0; i < turn.size() && left_ > 1; ++i) {
        Group& group = groups_[turn[i]];
        if (group.reached.empty()) continue;  // it has met another one
        if (group.next < group.reached.size()) {
          visit(group.reached[group.next++], turn[i]);
          continue;
        }
        split_off(std::exchange(group.reached, {}));
        --left_;
      }
      std::erase_if(turn, [&](std::uint32_t g) { return groups_[g].reached.empty(); });
    }
  }

 private:
  struct Group {
    std::vector<TetId> reached;
    std::size_t next = 0;  // those before it have been visited
  };
  struct Owner {
    std::uint32_t group = kNone;
  };

  void visit(TetId t, std::uint32_t group) {
    for (const TetId other : complex_.behind[t]) {
      if (complex_.tissue(other) != complex_.tissue(t)) continue;
      Owner& owner = group_of_[other];
      group = joined_.root(group);
      if (owner.group == kNone) {
        owner.group = group;
        groups_[group].reached.push_back(other);
      } else if (joined_.root(owner.group) != group) {
        join(joined_.root(owner.group), group);
      }
    }
  }

  // The larger one takes the other; those that have been visited stay in front.
  void join(std::uint32_t a, std::uint32_t b) {
    Group taken = std::move(groups_[std::max(a, b)]), &whole = groups_[std::min(a, b)];
    groups_[std::max(a, b)] = {};
    joined_.join(a, b);
    if (taken.reached.size() > whole.reached.size()) std::swap(taken, whole);
    for (std::size_t i = 0; i < taken.reached.size(); ++i) {
      whole.reached.push_back(taken.reached[i]);
      if (i < taken.next) std::swap(whole.reached[whole.next++], whole.reached.back());
    }
    --left_;
  }

  const TetComplex& complex_;
  DisjointSets joined_;
  std::vector<Group> groups_;  // by root of joined_
  TetMap<Owner> group_of_;
  std::size_t left_;
};

class PieceUpdate {
 public:
  PieceUpdate(const TetComplex& complex, Pieces& pieces, std::span<const TetId> changed)
      : complex_(complex), pieces_(pieces), changed_(changed), state_(complex.mesh.tets.size(), kSame) {}

  void run() {
    take_out();
    for (const TetId t : changed_) {
      if (state_[t] == kChanged) look_around(reach(t));
    }
    split_rest();
    for (const TetId t : changed_) {
      if (complex_.tissue(t) != 0 && pieces_.of_tet[t] == kNone) put_in(t);
    }
  }

 private:
  enum State : char { kSame, kChanged, kReached, kSplit };

  void take_out() {
    pieces_.of_tet.resize(state_.size(), kNone);
    for (const TetId t : changed_) {
      state_[t] = kChanged;
      move(t, kNone);
    }
  }

  void move(TetId t, std::uint32_t piece) {
    if (pieces_.of_tet[t] != kNone) --pieces_.list[pieces_.of_tet[t]].tets;
    if (piece != kNone) ++pieces_.list[piece].tets;
    pieces_.of_tet[t] = piece;
  }

  std::uint32_t new_piece(TetId first) {
    pieces_.list.push_back({complex_.tissue(first), 0, first});
    return static_cast<std::uint32_t>(pieces_.list.size() - 1);
  }

  // The changed tetrahedra that hang together with one, whatever their tissues.
  std::vector<TetId> reach(TetId first) {
    std::vector<TetId> reached = {first};
    state_[first] = kReached;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const TetId other : complex_.behind[reached[i]]) {
        if (state_[other] != kChanged) continue;
        state_[other] = kReached;
        reached.push_back(other);
      }
    }
    return reached;
  }

  // A piece that changed tetrahedra were part of hangs together still if what lies around each group of them does.
  void look_around(const std::vector<TetId>& group) {
    std::vector<std::pair<std::uint32_t, TetId>> around;
    for (const TetId t : group) {
      for (const TetId other : complex_.behind[t]) {
        if (pieces_.of_tet[other] != kNone) around.emplace_back(pieces_.of_tet[other], other);
      }
    }
    sort_and_unify(around);
    for (std::size_t i = 0; i < around.size();) {
      const std::uint32_t piece = around[i].first;
      std::vector<TetId> tets;
      for (; i < around.size() && around[i].first == piece; ++i) tets.push_back(around[i].second);
      look_apart(piece, std::move(tets));
    }
  }

  // Where a part has been split off, what else was beside it may have hung together through it only.
  void look_apart(std::uint32_t piece, std::vector<TetId> tets) {
    const std::size_t all = tets.size();
    split(tets);
    if (!tets.empty() && tets.size() < all) beside_split_.emplace_back(piece, tets.front());
  }

  // Finds the parts of a piece that do not hang together with the last of these tetrahedra, and takes those of such
  // parts out of the list.
  void split(std::vector<TetId>& tets) {
    const auto drop_split = [&] { std::erase_if(tets, [&](TetId t) { return state_[t] == kSplit; }); };
    drop_split();
    if (tets.size() < 2) return;
    JointSearch(complex_, tets).run([&](std::vector<TetId> part) {
      for (const TetId t : part) {
        if (pieces_.of_tet[t] != kNone) state_[t] = kSplit;
      }
      parts_.push_back(std::move(part));
    });
    drop_split();
  }

  void split_rest() {
    sort_and_unify(beside_split_);
    for (std::size_t i = 0; i < beside_split_.size();) {
      const std::uint32_t piece = beside_split_[i].first;
      std::vector<TetId> tets;
      for (; i < beside_split_.size() && beside_split_[i].first == piece; ++i) tets.push_back(beside_split_[i].second);
      split(tets);
    }
    for (const std::vector<TetId>& part : parts_) {
      const std::uint32_t piece = new_piece(part.front());
      for (const TetId t : part) {
        if (pieces_.of_tet[t] != kNone) move(t, piece);
      }
    }
  }

  // With all changed tetrahedra of its tissue that it hangs together with, to the largest piece beside them.
  void put_in(TetId first) {
    const auto is_open = [&](TetId t) {
      return state_[t] == kReached && pieces_.of_tet[t] == kNone && complex_.tissue(t) == complex_.tissue(first);
    };
    std::vector<TetId> group = {first}, beside;
    const std::uint32_t alone = new_piece(first);
    move(first, alone);
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (const TetId other : complex_.behind[group[i]]) {
        if (is_open(other)) {
          move(other, alone);
          group.push_back(other);
        } else if (complex_.tissue(other) == complex_.tissue(first) && pieces_.of_tet[other] != alone) {
          beside.push_back(other);
        }
      }
    }
    for (const TetId other : beside) join(first, other);
    if (pieces_.list.back().tets == 0) pieces_.list.pop_back();
  }

  // Makes one of the pieces of two tetrahedra: the larger one takes the smaller.
  void join(TetId a, TetId b) {
    const auto size = [&](TetId t) { return pieces_.list[pieces_.of_tet[t]].tets; };
    if (size(a) > size(b)) std::swap(a, b);
    const std::uint32_t from = pieces_.of_tet[a], to = pieces_.of_tet[b];
    if (from == to) return;
    std::vector<TetId> reached = {a};
    move(a, to);
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const TetId other : complex_.behind[reached[i]]) {
        if (pieces_.of_tet[other] != from) continue;
        move(other, to);
        reached.push_back(other);
      }
    }
  }

  const TetComplex& complex_;
  Pieces& pieces_;
  std::span<const TetId> changed_;
  std::vector<char> state_;
  std::vector<std::vector<TetId>> parts_;                      // that have been split off
  std::vector<std::pair<std::uint32_t, TetId>> beside_split_;  // pieces, and tetrahedra of what is left of them there
};

}  // namespace

void update_pieces(const TetComplex& complex, Pieces& pieces, std::span<const TetId> changed) {
  if (changed.size() > complex.mesh.tets.size() / kMuch || !complex.joined_beyond.empty()) {
    pieces = find_pieces(complex);
  } else {
    PieceUpdate(complex, pieces, changed).run();
  }
}

}  // namespace anatomesh
