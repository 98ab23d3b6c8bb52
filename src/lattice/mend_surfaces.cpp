#include "lattice/mend_surfaces.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "lattice/update_pieces.h"

namespace anatomesh {
namespace {

// The tetrahedra around a vertex, grouped into fans: those of one tissue reached through faces at the vertex. One a
// thread is used again and again.
class Star {
 public:
  unsigned defect(const TetComplex& complex, VertexId v) {
    tets_ = complex.tets_of_vertex[v];
    if (tets_.empty()) return 0;
    const TissueId first = complex.tissue(tets_[0]);
    if (std::all_of(tets_.begin(), tets_.end(), [&](TetId t) { return complex.tissue(t) == first; })) return 0;
    own_.clear();
    for (const TetId t : tets_) own_.push_back(complex.tissue(t));
    list_faces(complex, v);
    group_into_fans();
    tissues_.clear();
    unsigned fans = 0;
    for (std::size_t i = 0; i < own_.size(); ++i) {
      if (parent_[i] != i) continue;
      ++fans;
      if (std::ranges::find(tissues_, own_[i]) == tissues_.end()) tissues_.push_back(own_[i]);
    }
    unsigned defect = fans - static_cast<unsigned>(tissues_.size());
    if (tissues_.size() == 2) return 2 * defect;  // the rest of one is the other
    fan_ = parent_;
    for (const TissueId tissue : tissues_) defect += pieces_without(tissue) - 1;
    return defect;
  }

 private:
  using Place = std::uint16_t;  // in the star

  // The faces at the vertex between two tetrahedra of the star.
  void list_faces(const TetComplex& complex, VertexId v) {
    number_tets();
    faces_.clear();
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      const auto& tet = complex.mesh.tets[tets_[i]];
      const auto& behind = complex.behind[tets_[i]];
      for (std::size_t n = 0; n < 4; ++n) {
        if (tet[n] != v && behind[n] < tets_[i]) faces_.emplace_back(static_cast<Place>(i), place_of(behind[n]));
      }
    }
  }

  // A small hash table: tetrahedra that are numbered one after the other go to places one after the other.
  void number_tets() {
    std::size_t size = 64;
    while (size < 2 * tets_.size()) size *= 2;
    table_.assign(size, kNowhere);
    for (std::size_t i = 0; i < tets_.size(); ++i) {
      std::size_t at = home_of(tets_[i]);
      while (table_[at] != kNowhere) at = (at + 1) & (table_.size() - 1);
      table_[at] = static_cast<Place>(i);
    }
  }
  std::size_t home_of(TetId t) const { return (t ^ t >> 7u ^ t >> 15u) & (table_.size() - 1); }
  Place place_of(TetId t) const {
    std::size_t at = home_of(t);
    while (tets_[table_[at]] != t) at = (at + 1) & (table_.size() - 1);
    return table_[at];
  }

  void group_into_fans() {
    parent_.resize(tets_.size());
    std::iota(parent_.begin(), parent_.end(), Place{0});
    rims_.clear();
    for (const auto& [i, j] : faces_) {
      if (own_[i] == own_[j]) {
        join(i, j);
      } else {
        rims_.emplace_back(i, j);
      }
    }
  }

  // Pieces of the star without the fans of a tissue.
  unsigned pieces_without(TissueId tissue) {
    parent_ = fan_;
    unsigned pieces = 0;
    for (std::size_t i = 0; i < own_.size(); ++i) pieces += fan_[i] == i && own_[i] != tissue;
    for (const auto& [i, j] : rims_) {
      if (own_[i] != tissue && own_[j] != tissue) pieces -= join(i, j);
    }
    return pieces;
  }

  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool join(std::size_t i, std::size_t j) {
    i = root(i);
    j = root(j);
    parent_[std::max(i, j)] = static_cast<Place>(std::min(i, j));
    return i != j;
  }

  static constexpr Place kNowhere = 0xffff;

  std::span<const TetId> tets_;
  std::vector<TissueId> own_;                   // of the tetrahedra
  std::vector<TissueId> tissues_;               // each once
  std::vector<Place> table_;                    // places of tetrahedra
  std::vector<Place> parent_, fan_;             // union-find over the star
  std::vector<std::pair<Place, Place>> faces_;  // between two tetrahedra
  std::vector<std::pair<Place, Place>> rims_;   // those between two tissues
};

// Ascending, each once.
std::vector<TissueId> tissues_at(const TetComplex& complex, VertexId v) {
  std::vector<TissueId> tissues;
  for (const TetId t : complex.tets_of_vertex[v]) tissues.push_back(complex.tissue(t));
  sort_and_unify(tissues);
  return tissues;
}

// Whether giving these tetrahedra to a tissue joins none of its pieces and makes no other piece vanish.
bool joins_no_pieces(const TetComplex& complex, const Pieces& pieces, std::span<const TetId> tets, TissueId tissue) {
  std::map<std::uint32_t, std::uint32_t> taken;
  std::uint32_t joined = Pieces::kNone;
  bool joins = false;
  const auto touch = [&](TetId t) {
    if (tissue == 0 || complex.tissue(t) != tissue) return;
    joins = joins || (joined != Pieces::kNone && joined != pieces.of_tet[t]);
    joined = pieces.of_tet[t];
  };
  for (const TetId t : tets) {
    touch(t);
    for (const TetId other : complex.behind[t]) touch(other);
    if (complex.tissue(t) != 0 && complex.tissue(t) != tissue) ++taken[pieces.of_tet[t]];
  }
  return !joins && std::none_of(taken.begin(), taken.end(),
                                [&](const auto& piece) { return pieces.list[piece.first].tets <= piece.second; });
}

// Whether the tetrahedra of a tissue behind the faces of some (the fan), outside a group (ascending) that holds the
// fan, hang together around the fan without the group.
bool hangs_together_without(const TetComplex& complex, std::span<const TetId> fan, TissueId tissue,
                            std::span<const TetId> group) {
  const auto stays = [&](TetId t) {
    return complex.tissue(t) == tissue && !std::binary_search(group.begin(), group.end(), t);
  };
  std::vector<TetId> wanted, around;
  for (const TetId t : fan) {
    for (const TetId other : complex.behind[t]) {
      if (stays(other)) wanted.push_back(other);
    }
  }
  if (wanted.size() < 2) return true;
  for (const TetId t : fan) {
    for (const VertexId v : complex.mesh.tets[t]) {
      for (const TetId other : complex.tets_of_vertex[v]) {
        if (stays(other)) around.push_back(other);
      }
    }
  }
  sort_and_unify(around);
  std::vector<char> seen(around.size(), 0);
  const auto place = [&](TetId t) {
    return static_cast<std::size_t>(std::lower_bound(around.begin(), around.end(), t) - around.begin());
  };
  std::vector<TetId> reached = {wanted.front()};
  seen[place(wanted.front())] = 1;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const TetId other : complex.behind[reached[i]]) {
      const std::size_t at = place(other);
      if (at == around.size() || around[at] != other || seen[at]) continue;
      seen[at] = 1;
      reached.push_back(other);
    }
  }
  return std::all_of(wanted.begin(), wanted.end(), [&](TetId t) { return seen[place(t)]; });
}

// Whether no tissue but one falls apart when it takes all tetrahedra of a star: each fan of the others can go.
bool splits_no_pieces(const TetComplex& complex, std::span<const TetId> star, TissueId taker) {
  std::vector<char> seen(star.size(), 0);
  for (std::size_t first = 0; first < star.size(); ++first) {
    const TissueId tissue = complex.tissue(star[first]);
    if (seen[first] || tissue == 0 || tissue == taker) continue;
    std::vector<TetId> fan = {star[first]};
    seen[first] = 1;
    for (std::size_t i = 0; i < fan.size(); ++i) {
      for (const TetId other : complex.behind[fan[i]]) {
        const auto at = static_cast<std::size_t>(std::lower_bound(star.begin(), star.end(), other) - star.begin());
        if (at == star.size() || star[at] != other || seen[at] || complex.tissue(other) != tissue) continue;
        seen[at] = 1;
        fan.push_back(other);
      }
    }
    if (!hangs_together_without(complex, fan, tissue, star)) return false;
  }
  return true;
}

// Relabels single tetrahedra, or all at a vertex, as long as that leaves fewer defects.
class LabelMender {
 public:
  LabelMender(TetComplex& complex, Pieces& pieces, const RelabelPrice& price, double max_price)
      : complex_(complex),
        pieces_(pieces),
        price_(price),
        max_price_(max_price),
        changed_at_(complex.mesh.points_mm.size(), 0),
        stuck_at_(changed_at_) {}

  // Does what it can at a vertex. What could not be done once is not tried again before something changes around it.
  void mend(VertexId v, std::vector<TetId>& changed) {
    if (is_stuck(v)) return;
    ++time_;
    while (star_defect(complex_, v) > 0 && mend_by_one(v, changed)) {
    }
    if (star_defect(complex_, v) == 0 || mend_by_star(v, changed)) return;
    stuck_at_[v] = ++time_;
  }

 private:
  // All that is looked at lies at a vertex of the tetrahedra around v, and so does what makes a piece grow that must
  // not vanish.
  bool is_stuck(VertexId v) const {
    if (stuck_at_[v] == 0) return false;
    return std::ranges::all_of(complex_.tets_of_vertex[v], [&](TetId t) {
      return std::ranges::all_of(complex_.mesh.tets[t], [&](VertexId w) { return changed_at_[w] < stuck_at_[v]; });
    });
  }

  void set_tissue(TetId t, TissueId tissue) {
    complex_.mesh.tissues[t] = tissue;
    for (const VertexId v : complex_.mesh.tets[t]) changed_at_[v] = time_;
  }

  // Takes the tetrahedron at v, and the tissue for it, that leave fewest defects; of equal ones the cheapest.
  // Returns whether there was one.
  bool mend_by_one(VertexId v, std::vector<TetId>& changed) {
    best_ = {};
    defects_.clear();
    for (const TetId t : complex_.tets_of_vertex[v]) try_tet(t);
    if (best_.gain == 0) return false;
    relabel(best_.tet, best_.tissue);
    changed.push_back(best_.tet);
    return true;
  }

  // Takes the tissue that, given to all tetrahedra at v, leaves fewest defects. Returns whether there was one.
  bool mend_by_star(VertexId v, std::vector<TetId>& changed) {
    const auto star = complex_.tets_of_vertex[v];
    std::vector<TissueId> own;
    std::vector<VertexId> vertices;
    for (const TetId t : star) {
      own.push_back(complex_.tissue(t));
      vertices.insert(vertices.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
    }
    sort_and_unify(vertices);
    const std::vector<TissueId> tissues = tissues_at(complex_, v);
    const unsigned before = defects_at(vertices);
    Choice best;
    for (const TissueId tissue : tissues) {
      if (!joins_no_pieces(complex_, pieces_, star, tissue) || !splits_no_pieces(complex_, star, tissue)) continue;
      double price = 0;
      for (const TetId t : star) price += complex_.tissue(t) == tissue ? 0 : price_(t, tissue);
      if (price > max_price_) continue;
      for (const TetId t : star) complex_.mesh.tissues[t] = tissue;
      const unsigned after = defects_at(vertices);
      for (std::size_t i = 0; i < star.size(); ++i) complex_.mesh.tissues[star[i]] = own[i];
      if (after < before && before - after > best.gain) best = {before - after, price, star[0], tissue};
    }
    if (best.gain == 0) return false;
    std::uint32_t piece = Pieces::kNone;
    for (const TetId t : star) {
      if (best.tissue != 0 && complex_.tissue(t) == best.tissue) piece = pieces_.of_tet[t];
    }
    for (const TetId t : star) {
      if (complex_.tissue(t) == best.tissue) continue;
      if (complex_.tissue(t) != 0) --pieces_.list[pieces_.of_tet[t]].tets;
      set_tissue(t, best.tissue);
      pieces_.of_tet[t] = piece;
      if (piece != Pieces::kNone) ++pieces_.list[piece].tets;
      changed.push_back(t);
    }
    return true;
  }

  unsigned defects_at(const std::vector<VertexId>& vertices) const {
    unsigned sum = 0;
    for (const VertexId v : vertices) sum += star_defect(complex_, v);
    return sum;
  }

  struct Choice {
    unsigned gain = 0;  // defects fewer
    double price = 0;
    TetId tet = 0;
    TissueId tissue = 0;
  };

  void try_tet(TetId t) {
    const TissueId own = complex_.tissue(t);
    std::array<TissueId, 4> tried;
    std::size_t count = 0;
    unsigned before = 0;
    for (const TetId other : complex_.behind[t]) {
      const TissueId tissue = complex_.tissue(other);
      if (tissue == own || std::find(tried.begin(), tried.begin() + count, tissue) != tried.begin() + count) continue;
      if (count == 0) before = defect_around(t);
      tried[count++] = tissue;
      const unsigned least = std::max(1u, best_.gain);
      if (before < least) continue;
      const unsigned after = defect_around_as(t, tissue, before - least);
      if (after > before - least) continue;
      const Choice choice = {before - after, price_(t, tissue), t, tissue};
      if (choice.price > max_price_ || (choice.gain == best_.gain && choice.price >= best_.price)) continue;
      if (keeps_pieces(t, tissue)) best_ = choice;
    }
  }

  unsigned defect_around(TetId t) {
    unsigned sum = 0;
    for (const VertexId v : complex_.mesh.tets[t]) {
      const auto known = std::ranges::find(defects_, v, &VertexDefect::vertex);
      if (known != defects_.end()) {
        sum += known->defect;
        continue;
      }
      defects_.push_back({v, star_defect(complex_, v)});
      sum += defects_.back().defect;
    }
    return sum;
  }

  // If the tetrahedron were of this tissue; at least something above `most` where it is more than that.
  unsigned defect_around_as(TetId t, TissueId tissue, unsigned most) {
    const TissueId own = std::exchange(complex_.mesh.tissues[t], tissue);
    unsigned sum = 0;
    for (const VertexId v : complex_.mesh.tets[t]) {
      sum += star_defect(complex_, v);
      if (sum > most) break;
    }
    complex_.mesh.tissues[t] = own;
    return sum;
  }

  bool keeps_pieces(TetId t, TissueId tissue) const {
    std::uint32_t joined = Pieces::kNone;
    for (const TetId other : complex_.behind[t]) {
      if (tissue == 0 || complex_.tissue(other) != tissue) continue;
      if (joined != Pieces::kNone && pieces_.of_tet[other] != joined) return false;
      joined = pieces_.of_tet[other];
    }
    if (complex_.tissue(t) == 0) return true;
    return pieces_.list[pieces_.of_tet[t]].tets > 1 && neighbours_hang_together(complex_, t);
  }

  void relabel(TetId t, TissueId tissue) {
    if (complex_.tissue(t) != 0) --pieces_.list[pieces_.of_tet[t]].tets;
    set_tissue(t, tissue);
    pieces_.of_tet[t] = Pieces::kNone;
    if (tissue == 0) return;
    for (const TetId other : complex_.behind[t]) {
      if (other != t && complex_.tissue(other) == tissue) pieces_.of_tet[t] = pieces_.of_tet[other];
    }
    ++pieces_.list[pieces_.of_tet[t]].tets;
  }

  TetComplex& complex_;
  Pieces& pieces_;
  const RelabelPrice& price_;
  double max_price_;
  Choice best_;
  struct VertexDefect {
    VertexId vertex;
    unsigned defect;
  };
  std::uint32_t time_ = 0;
  std::vector<std::uint32_t> changed_at_;  // by vertex: when a tetrahedron there was relabelled
  std::vector<std::uint32_t> stuck_at_;    // by vertex: when the last attempt was in vain, 0 for none
  std::vector<VertexDefect> defects_;      // of the vertices around the one that is mended
};

}  // namespace

unsigned star_defect(const TetComplex& complex, VertexId v) {
  thread_local Star star;
  return star.defect(complex, v);
}

namespace {

// Ascending, each once.
void sort_once(std::vector<VertexId>& vertices, std::size_t vertex_count) {
  constexpr std::size_t kFew = 16;
  if (vertices.size() < vertex_count / kFew) {
    sort_and_unify(vertices);
    return;
  }
  std::vector<char> listed(vertex_count, 0);
  for (const VertexId v : vertices) listed[v] = 1;
  vertices.clear();
  for (VertexId v = 0; v < vertex_count; ++v) {
    if (listed[v]) vertices.push_back(v);
  }
}

}  // namespace

std::vector<VertexId> singular_among(const TetComplex& complex, std::vector<VertexId> vertices) {
  sort_once(vertices, complex.mesh.points_mm.size());
  std::vector<char> singular(vertices.size());
  parallel_for(vertices.size(), [&](std::size_t i) { singular[i] = star_defect(complex, vertices[i]) > 0; });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (singular[i]) vertices[kept++] = vertices[i];
  }
  vertices.resize(kept);
  return vertices;
}

std::vector<VertexId> singular_vertices(const TetComplex& complex) {
  std::vector<VertexId> all(complex.mesh.points_mm.size());
  std::iota(all.begin(), all.end(), VertexId{0});
  return singular_among(complex, std::move(all));
}

// A search that ends as soon as all neighbours are reached, mostly after a few steps.
bool neighbours_hang_together(const TetComplex& complex, TetId t) {
  const auto& corners = complex.mesh.tets[t];
  const TissueId tissue = complex.tissue(t);
  std::array<TetId, 4> wanted;
  std::size_t missing = 0;
  for (const TetId other : complex.behind[t]) {
    if (other != t && complex.tissue(other) == tissue) wanted[missing++] = other;
  }
  if (missing < 2) return true;
  const auto is_around = [&](TetId other) {
    const auto& tet = complex.mesh.tets[other];
    return std::any_of(tet.begin(), tet.end(), [&](VertexId v) {
      return v == corners[0] || v == corners[1] || v == corners[2] || v == corners[3];
    });
  };
  thread_local std::vector<TetId> reached;
  reached.assign(1, wanted[--missing]);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const TetId other : complex.behind[reached[i]]) {
      if (other == t || complex.tissue(other) != tissue) continue;
      if (std::find(reached.begin(), reached.end(), other) != reached.end() || !is_around(other)) continue;
      reached.push_back(other);
      const auto end = wanted.begin() + static_cast<std::ptrdiff_t>(missing);
      const auto found = std::find(wanted.begin(), end, other);
      if (found == end) continue;
      *found = wanted[--missing];
      if (missing == 0) return true;
    }
  }
  return false;
}

std::vector<VertexId> mend_single_tets(TetComplex& complex, Pieces& pieces, std::vector<VertexId> singular,
                                       const RelabelPrice& price, double max_price, std::vector<TetId>& changed) {
  LabelMender mender(complex, pieces, price, max_price);
  // Every step leaves fewer defects in all, so this ends; but it may open a vertex that was sound.
  for (bool progress = true; progress;) {
    progress = false;
    std::vector<VertexId> next = singular;
    for (const VertexId v : singular) {
      const std::size_t done = changed.size();
      mender.mend(v, changed);
      progress = progress || changed.size() > done;
      for (std::size_t i = done; i < changed.size(); ++i) {
        const auto& tet = complex.mesh.tets[changed[i]];
        next.insert(next.end(), tet.begin(), tet.end());
      }
    }
    if (progress) singular = singular_among(complex, std::move(next));
  }
  return singular;
}

namespace {

// Tetrahedra that hang together, and the tissues one of which they are to have.
struct Group {
  std::vector<TetId> tets;
  std::vector<TissueId> tissues;  // ascending
};

// Cuts the tetrahedra at some vertices into groups, from one vertex to the next.
class Grouping {
 public:
  Grouping(const TetComplex& complex, std::span<const VertexId> vertices, Reach reach)
      : complex_(complex),
        reach_(reach),
        is_open_(complex.mesh.points_mm.size(), 0),
        is_grouped_(complex.mesh.tets.size(), 0) {
    for (const VertexId v : vertices) is_open_[v] = 1;
  }

  Group around(VertexId first) {
    Group group;
    if (!is_open_[first]) return group;
    group.tissues = tissues_at(complex_, first);
    is_open_[first] = 0;
    std::vector<VertexId> reached = {first};
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (const TetId t : complex_.tets_of_vertex[reached[i]]) {
        if (is_grouped_[t]) continue;
        is_grouped_[t] = 1;
        group.tets.push_back(t);
        for (const VertexId v : complex_.mesh.tets[t]) {
          if (is_open_[v] && joins(group, v)) reached.push_back(v);
        }
      }
    }
    std::ranges::sort(group.tets);
    return group;
  }

 private:
  // Whether the group can take in a vertex, which then is no longer open.
  bool joins(Group& group, VertexId v) {
    const std::vector<TissueId> there = tissues_at(complex_, v);
    std::vector<TissueId> tissues;
    if (reach_ == Reach::one_tissue) {
      std::ranges::set_intersection(group.tissues, there, std::back_inserter(tissues));
    } else {
      std::ranges::set_union(group.tissues, there, std::back_inserter(tissues));
    }
    if (tissues.empty()) return false;
    group.tissues = std::move(tissues);
    is_open_[v] = 0;
    return true;
  }

  const TetComplex& complex_;
  Reach reach_;
  std::vector<char> is_open_;     // by vertex: one that no group has yet
  std::vector<char> is_grouped_;  // by tetrahedron
};

// All of them are cut before any tetrahedron changes.
std::vector<Group> grouped(const TetComplex& complex, std::span<const VertexId> vertices, Reach reach) {
  Grouping grouping(complex, vertices, reach);
  std::vector<Group> groups;
  for (const VertexId v : vertices) {
    Group group = grouping.around(v);
    if (!group.tets.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

// That of the largest volume, if it can be.
TissueId choose_tissue(const TetComplex& complex, const Pieces& pieces, const Group& group,
                       std::span<const float> sizes) {
  std::map<TissueId, double> volume;
  for (const TissueId tissue : group.tissues) volume[tissue] = 0;
  for (const TetId t : group.tets) {
    const auto known = volume.find(complex.tissue(t));
    if (known != volume.end()) known->second += static_cast<double>(sizes[t]);
  }
  std::vector<std::pair<double, TissueId>> order;
  for (const auto& [tissue, v] : volume) order.emplace_back(-v, tissue);
  std::sort(order.begin(), order.end());
  for (const auto& [v, tissue] : order) {
    if (joins_no_pieces(complex, pieces, group.tets, tissue)) return tissue;
  }
  return order.front().second;
}

}  // namespace

void mend_neighbourhoods(TetComplex& complex, Pieces& pieces, std::span<const VertexId> vertices, Reach reach,
                         std::span<const float> sizes, std::size_t max_tets, std::vector<TetId>& changed) {
  const std::size_t done = changed.size();
  for (const Group& group : grouped(complex, vertices, reach)) {
    if (group.tets.size() > max_tets) continue;
    const TissueId tissue = choose_tissue(complex, pieces, group, sizes);
    for (const TetId t : group.tets) {
      if (complex.tissue(t) == tissue) continue;
      complex.mesh.tissues[t] = tissue;
      changed.push_back(t);
    }
  }
  update_pieces(complex, pieces, std::span(changed).subspan(done));
}

}  // namespace anatomesh
