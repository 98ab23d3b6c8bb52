#include "lattice/tet_complex.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>

#include "base/parallel.h"

namespace anatomesh {
namespace {

constexpr std::size_t kGrain = 4096;

/// Union-find by many threads at once. Roots are the lowest of their sets, whatever the order.
class SharedSets {
 public:
  explicit SharedSets(std::size_t n) : parent_(n) {
    parallel_for(n, [&](std::size_t t) { parent_[t] = static_cast<TetId>(t); });
  }

  TetId root(TetId x) {
    for (;;) {
      const TetId up = at(x).load(std::memory_order_relaxed);
      if (up == x) return x;
      const TetId above = at(up).load(std::memory_order_relaxed);
      if (above == up) return up;
      at(x).store(above, std::memory_order_relaxed);  // any ancestor will do
      x = above;
    }
  }
  bool is_root(TetId x) const { return parent_[x] == x; }

  void join(TetId a, TetId b) {
    if (at(a).load(std::memory_order_relaxed) == at(b).load(std::memory_order_relaxed)) return;
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a > b) std::swap(a, b);
      TetId expected = b;
      if (at(b).compare_exchange_strong(expected, a, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<TetId> at(TetId x) { return std::atomic_ref(parent_[x]); }
  std::vector<TetId> parent_;
};

/// A face at its lowest vertex that waits for the tetrahedron on its other side.
struct OpenFace {
  std::uint64_t others;  ///< its other two vertices
  TetId tet;
  std::uint32_t corner;  ///< opposite to it
};

// Matches the faces whose lowest vertex is v. Both tetrahedra at a face are at v, so nothing else writes there.
void match_faces_at(TetComplex& complex, VertexId v, std::vector<OpenFace>& open) {
  open.clear();
  for (const TetId t : complex.tets_of_vertex[v]) {
    const auto& tet = complex.mesh.tets[t];
    for (std::uint32_t n = 0; n < 4; ++n) {
      const VertexId a = tet[(n + 1) % 4], b = tet[(n + 2) % 4], c = tet[(n + 3) % 4];
      if (std::min({a, b, c}) != v) continue;
      const VertexId high = std::max({a, b, c}), middle = a ^ b ^ c ^ v ^ high;
      const std::uint64_t others = std::uint64_t{middle} << 32u | high;
      const auto match = std::ranges::find(open, others, &OpenFace::others);
      if (match == open.end()) {
        open.push_back({others, t, n});
        continue;
      }
      complex.behind[t][n] = match->tet;
      complex.behind[match->tet][match->corner] = t;
      *match = open.back();
      open.pop_back();
    }
  }
  for (const OpenFace& face : open) complex.behind[face.tet][face.corner] = face.tet;
}

// The tetrahedron behind the face of t opposite to its corner n, or t.
TetId find_behind(const TetComplex& complex, TetId t, std::size_t n) {
  const auto& tet = complex.mesh.tets[t];
  const auto has = [&](TetId other, VertexId v) {
    return std::ranges::find(complex.mesh.tets[other], v) != complex.mesh.tets[other].end();
  };
  for (const TetId other : complex.tets_of_vertex[tet[(n + 1) % 4]]) {
    if (other != t && has(other, tet[(n + 2) % 4]) && has(other, tet[(n + 3) % 4])) return other;
  }
  return t;
}

// The lists of a mesh that has tetrahedron t of another, with the lists `before`, as number[t], and some that are
// added.
VertexLists<TetId> renumbered(const VertexLists<TetId>& before, std::span<const TetId> number, const TissueMesh& mesh,
                              std::span<const TetId> added) {
  VertexLists<TetId> lists;
  lists.begin.assign(mesh.points_mm.size() + 1, 0);
  parallel_for(before.size(), [&](std::size_t v) {
    std::uint32_t kept = 0;
    for (const TetId t : before[v]) kept += number[t] != TetComplex::kNone;
    lists.begin[v + 1] = kept;
  });
  for (const TetId t : added) {
    for (const VertexId v : mesh.tets[t]) ++lists.begin[v + 1];
  }
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  lists.items.resize(lists.begin.back());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  parallel_for(before.size(), [&](std::size_t v) {
    for (const TetId t : before[v]) {
      if (number[t] != TetComplex::kNone) lists.items[next[v]++] = number[t];
    }
  });
  for (const TetId t : added) {
    for (const VertexId v : mesh.tets[t]) lists.items[next[v]++] = t;
  }
  parallel_for(lists.size(), [&](std::size_t v) {
    const std::span<TetId> list(&lists.items[0] + lists.begin[v], &lists.items[0] + lists.begin[v + 1]);
    if (!std::ranges::is_sorted(list)) std::ranges::sort(list);
  });
  return lists;
}

}  // namespace

TetComplex make_complex(TissueMesh mesh) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  complex.tets_of_vertex = tets_of_vertices(complex.mesh.points_mm.size(), complex.mesh.tets);
  complex.behind.resize(complex.mesh.tets.size());
  parallel_for(complex.mesh.points_mm.size(), [&](std::size_t v) {
    thread_local std::vector<OpenFace> open;
    match_faces_at(complex, static_cast<VertexId>(v), open);
  });
  return complex;
}

TetComplex remake_complex(const TetComplex& before, TissueMesh mesh, std::span<const TetId> from) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  std::vector<TetId> number(before.mesh.tets.size(), TetComplex::kNone);
  parallel_for(from.size(), [&](std::size_t t) {
    if (from[t] != TetComplex::kNone) number[from[t]] = static_cast<TetId>(t);
  });
  std::vector<TetId> added;
  std::vector<char> at_new(complex.mesh.points_mm.size(), 0);  // vertices of tetrahedra that are new
  for (TetId t = 0; t < from.size(); ++t) {
    if (from[t] != TetComplex::kNone) continue;
    added.push_back(t);
    for (const VertexId v : complex.mesh.tets[t]) at_new[v] = 1;
  }
  complex.tets_of_vertex = renumbered(before.tets_of_vertex, number, complex.mesh, added);
  complex.behind.resize(complex.mesh.tets.size());
  parallel_for(from.size(), [&](std::size_t i) {
    const auto t = static_cast<TetId>(i);
    std::array<TetId, 4>& behind = complex.behind[t];
    if (from[t] == TetComplex::kNone) {
      for (std::size_t n = 0; n < 4; ++n) behind[n] = find_behind(complex, t, n);
      return;
    }
    bool is_inside = true;
    for (std::size_t n = 0; n < 4; ++n) {
      behind[n] = number[before.behind[from[t]][n]];
      is_inside = is_inside && behind[n] != TetComplex::kNone && behind[n] != t;
    }
    for (std::size_t n = 0; !is_inside && n < 4; ++n) {  // beyond the border there may be something now
      const bool may_have_new = behind[n] == t && at_new[complex.mesh.tets[t][(n + 1) % 4]];
      if (behind[n] == TetComplex::kNone || may_have_new) behind[n] = find_behind(complex, t, n);
    }
  });
  return complex;
}

namespace {

// Numbers the roots of tissues in ascending order.
void list_roots(const std::vector<TissueId>& tissues, const SharedSets& sets, Pieces& pieces) {
  const auto for_each_root = [&](std::size_t begin, std::size_t end, const auto& visit) {
    for (std::size_t t = begin; t < end; ++t) {
      if (tissues[t] != 0 && sets.is_root(static_cast<TetId>(t))) visit(static_cast<TetId>(t));
    }
  };
  std::vector<std::uint32_t> next(tissues.size() / kGrain + 2, 0);  // by block
  parallel_blocks(tissues.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for_each_root(begin, end, [&](TetId) { ++next[begin / kGrain + 1]; });
  });
  std::partial_sum(next.begin(), next.end(), next.begin());
  pieces.list.resize(next.back());
  parallel_blocks(tissues.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for_each_root(begin, end, [&](TetId t) {
      pieces.of_tet[t] = next[begin / kGrain]++;
      pieces.list[pieces.of_tet[t]] = {tissues[t], 0, t};
    });
  });
}

}  // namespace

Pieces find_pieces(const TetComplex& complex) {
  const auto& tissues = complex.mesh.tissues;
  SharedSets sets(tissues.size());
  parallel_for(tissues.size(), [&](std::size_t t) {
    if (tissues[t] == 0) return;
    for (const TetId other : complex.behind[t]) {
      if (other < t && tissues[other] == tissues[t]) sets.join(static_cast<TetId>(t), other);
    }
  });
  for (const auto& [a, b] : complex.joined_beyond) {
    if (tissues[a] == tissues[b] && tissues[a] != 0) sets.join(a, b);
  }
  Pieces pieces;
  pieces.of_tet.assign(tissues.size(), Pieces::kNone);
  list_roots(tissues, sets, pieces);
  parallel_blocks(tissues.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t piece = Pieces::kNone, count = 0;
    const auto add_up = [&] {
      if (count > 0) std::atomic_ref(pieces.list[piece].tets).fetch_add(count, std::memory_order_relaxed);
    };
    for (std::size_t t = begin; t < end; ++t) {
      if (tissues[t] == 0) continue;
      const TetId root = sets.root(static_cast<TetId>(t));
      if (root != t) pieces.of_tet[t] = pieces.of_tet[root];
      if (pieces.of_tet[t] != piece) {
        add_up();
        piece = pieces.of_tet[t];
        count = 0;
      }
      ++count;
    }
    add_up();
  });
  return pieces;
}

}  // namespace anatomesh
