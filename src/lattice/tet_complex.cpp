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

// The corner of a tetrahedron that is not one of another with which it shares a face.
std::size_t corner_beyond(const TissueMesh& mesh, TetId t, TetId other) {
  const auto& theirs = mesh.tets[other];
  const auto& own = mesh.tets[t];
  const auto corner =
      std::ranges::find_if(own, [&](VertexId v) { return std::ranges::find(theirs, v) == theirs.end(); });
  return static_cast<std::size_t>(corner - own.begin());
}

}  // namespace

VertexStars::VertexStars(VertexLists<TetId> lists) : places_(lists.size()), items_(std::move(lists.items)) {
  for (std::size_t v = 0; v < places_.size(); ++v) places_[v] = {lists.begin[v], lists.begin[v + 1] - lists.begin[v]};
}

// Lists that change move to the end.
void VertexStars::replace(std::span<const std::array<VertexId, 4>> tets, std::span<const TetId> dropped,
                          TetId first_added, std::size_t vertex_count) {
  places_.resize(vertex_count);
  std::vector<char> is_dropped(first_added, 0), is_touched(vertex_count, 0);
  std::vector<std::uint32_t> added(vertex_count, 0);
  for (const TetId t : dropped) {
    is_dropped[t] = 1;
    for (const VertexId v : tets[t]) is_touched[v] = 1;
  }
  for (const auto& tet : tets.subspan(first_added)) {
    for (const VertexId v : tet) is_touched[v] = 1, ++added[v];
  }
  std::vector<VertexId> touched;
  std::vector<std::uint32_t> begin;
  auto end = static_cast<std::uint32_t>(items_.size());
  for (VertexId v = 0; v < vertex_count; ++v) {
    if (!is_touched[v]) continue;
    touched.push_back(v);
    begin.push_back(end);
    end += places_[v].count + added[v];
  }
  items_.resize(end);
  parallel_for(touched.size(), [&](std::size_t i) {
    Place& place = places_[touched[i]];
    const auto first = items_.begin() + place.begin, to = items_.begin() + begin[i];
    const auto kept = std::remove_copy_if(first, first + place.count, to, [&](TetId t) { return is_dropped[t]; });
    place = {begin[i], static_cast<std::uint32_t>(kept - to)};
  });
  for (TetId t = first_added; t < tets.size(); ++t) {
    for (const VertexId v : tets[t]) items_[places_[v].begin + places_[v].count++] = t;
  }
}

TetComplex make_complex(TissueMesh mesh) {
  TetComplex complex;
  complex.mesh = std::move(mesh);
  complex.tets_of_vertex = VertexStars(tets_of_vertices(complex.mesh.points_mm.size(), complex.mesh.tets));
  complex.behind.resize(complex.mesh.tets.size());
  parallel_for(complex.mesh.points_mm.size(), [&](std::size_t v) {
    thread_local std::vector<OpenFace> open;
    match_faces_at(complex, static_cast<VertexId>(v), open);
  });
  return complex;
}

void replace_tets(TetComplex& complex, std::span<const TetId> dropped, TetId first_added) {
  complex.tets_of_vertex.replace(complex.mesh.tets, dropped, first_added, complex.mesh.points_mm.size());
  complex.behind.resize(complex.mesh.tets.size());
  for (const TetId t : dropped) {
    for (const TetId other : complex.behind[t]) std::ranges::replace(complex.behind[other], t, other);
    complex.behind[t].fill(t);
    complex.mesh.tissues[t] = 0;
  }
  parallel_for(complex.mesh.tets.size() - first_added, [&](std::size_t i) {
    const auto t = static_cast<TetId>(first_added + i);
    for (std::size_t n = 0; n < 4; ++n) complex.behind[t][n] = find_behind(complex, t, n);
  });
  for (TetId t = first_added; t < complex.mesh.tets.size(); ++t) {
    for (const TetId other : complex.behind[t]) {
      if (other < first_added) complex.behind[other][corner_beyond(complex.mesh, other, t)] = t;
    }
  }
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
