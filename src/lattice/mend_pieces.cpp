#include "lattice/mend_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "lattice/tet_map.h"
#include "lattice/update_pieces.h"

namespace anatomesh {
namespace {

constexpr std::uint32_t kNone = Pieces::kNone;

// Tetrahedra above these volumes (in voxels) are refined before they are relabelled.
constexpr float kSeedSize = 1.0f;   // to stand for a component
constexpr float kPathSize = 1.0f;   // to join pieces
constexpr float kCutSize = 0.7f;    // to separate components
constexpr float kTightSize = 0.1f;  // to do so where a tetrahedron holds voxels of the tissue it would lose

Vec3 centroid(const TissueMesh& mesh, TetId t) {
  Vec3 sum;
  for (const VertexId v : mesh.tets[t]) sum += 0.25 * mesh.points_mm[v];
  return sum;
}

// Voxels of a component in a piece.
struct Holding {
  std::uint32_t piece, component, voxels;
  bool is_of(std::uint32_t p, std::uint32_t c) const { return piece == p && component == c; }
};

// One for each piece and component, in ascending order.
void merge_holdings(std::vector<Holding>& holdings) {
  std::ranges::sort(holdings, {}, [](const Holding& h) { return std::pair(h.piece, h.component); });
  std::size_t kept = 0;
  for (const Holding& h : holdings) {
    if (kept > 0 && holdings[kept - 1].is_of(h.piece, h.component)) {
      holdings[kept - 1].voxels += h.voxels;
    } else {
      holdings[kept++] = h;
    }
  }
  holdings.resize(kept);
}

class PieceMender {
 public:
  PieceMender(TetComplex& complex, Pieces& pieces, const TissueImage& image, const ImageComponents& components,
              const TetContents& contents, std::vector<Claim>& claims)
      : complex_(complex),
        pieces_(pieces),
        image_(image),
        components_(components),
        contents_(contents),
        claims_(claims),
        price_(voxel_price(complex, image, contents)),
        changed_at_(complex.mesh.points_mm.size(), 0),
        locked_(contents.decided) {}

  PieceRepair run() {
    constexpr int kPasses = 4;
    std::size_t done = 0;
    for (int pass = 0; pass < kPasses; ++pass) {
      repair_.refine.clear();
      find_open_tissues();
      if (std::none_of(open_.begin(), open_.end(), [](char open) { return open; })) break;
      find_claims(done);
      done = repair_.changed.size();
      find_holdings();
      dissolve_empty_pieces();
      seed_absent_components();
      cut_shared_pieces();
      join_pieces();
      if (repair_.changed.size() == done) break;
      update_pieces_here(done);
    }
    sort_and_unify(repair_.refine);
    return repair_;
  }

 private:
  void update_pieces_here(std::size_t done);
  void find_open_tissues();
  Claim claim_of(TetId t) const;
  void find_claims(std::size_t done);
  void list_holdings();
  void find_holdings();
  void dissolve_empty_pieces();
  void dissolve(const std::vector<TetId>& tets);
  std::vector<Holding> find_absent_components() const;
  void seed_absent_components();
  void cut_shared_pieces();
  void cut(const std::vector<TetId>& tets);
  void cut_face(TetId a, TetId b);
  void join_pieces();
  double path_cost(TetId t, TissueId tissue) const;
  double split_cost(TetId t) const;
  bool refines_first(TetId t) const;
  void join_piece(std::uint32_t piece, const std::vector<TetId>& tets, DisjointSets& joined);
  // The last tetrahedron of a path, and the one of another piece behind it.
  struct Way {
    TetId last, reached;
  };
  std::optional<Way> find_way(std::uint32_t piece, const std::vector<TetId>& tets, DisjointSets& joined);
  void lay_path(std::uint32_t piece, const Way& way, DisjointSets& joined);
  void give_up(std::uint32_t piece, const std::vector<TetId>& tets);
  // A search after which nothing was relabelled. As long as nothing changes where it looked, another one would end in
  // the same way.
  struct VainSearch {
    std::uint32_t component = kNone;
    std::uint32_t number = 0;
    std::size_t tets = 0;  // of the piece
    std::vector<TetId> seen;
    std::vector<std::pair<TetId, std::uint32_t>> mains;  // of those of its tissue there, the components of their pieces
    std::vector<TetId> wanted;                           // to be refined first
  };
  VainSearch vain_search(std::uint32_t piece, const std::vector<TetId>& tets, std::vector<TetId> wanted) const;
  bool holds_still(const VainSearch& search, std::uint32_t piece, const std::vector<TetId>& tets) const;

  std::vector<std::vector<TetId>> tets_of(const std::vector<char>& wanted) const;
  TissueId other_tissue(TetId t) const;
  bool touches_other_component(TetId t, std::uint32_t component) const;
  void relabel(TetId t, TissueId tissue, std::uint32_t piece);
  std::uint32_t main_of(TetId t) const { return pieces_.of_tet[t] == kNone ? kNone : main_[pieces_.of_tet[t]]; }
  bool wants_refinement(TetId t, float size) {
    if (contents_.sizes[t] <= size || !contents_.may_refine[t]) return false;
    repair_.refine.push_back(t);
    return true;
  }

  TetComplex& complex_;
  Pieces& pieces_;
  const TissueImage& image_;
  const ImageComponents& components_;
  const TetContents& contents_;
  std::vector<Claim>& claims_;  // by tetrahedron, of open tissues
  RelabelPrice price_;
  struct Known {
    TetId from = 0;
    bool reached = false;
    double cost = -1;        // of a way through it, negative: not known yet
    double split_cost = -1;  // on top
  };
  TetMap<Known> known_;               // to the search for a path
  std::map<TetId, VainSearch> vain_;  // by the first tetrahedron of the piece
  std::size_t remembered_ = 0;        // tetrahedra that those have looked at
  std::uint32_t searches_ = 0;
  std::vector<std::uint32_t> changed_at_;  // by vertex: the number of the last search before a change beside it
  std::vector<std::uint32_t> region_;      // by tetrahedron of a piece that is cut: the component it goes to
  std::vector<char> locked_;               // relabelled by a repair: others go around it
  PieceRepair repair_;
  std::vector<std::pair<TetId, std::uint32_t>> was_of_;  // pieces of what was relabelled in this pass, before that

  std::vector<char> open_;           // by tissue: more than one piece or component
  std::vector<char> claimed_;        // by tissue: its claims are known
  std::vector<Holding> holdings_;    // by piece and component
  std::vector<std::uint32_t> main_;  // by piece: the component that it has most voxels of, kNone for none
  std::vector<std::uint32_t> home_;  // by component: the piece that has most of its voxels, kNone for none
};

// After the relabelling of all from `done` on.
void PieceMender::update_pieces_here(std::size_t done) {
  for (; !was_of_.empty(); was_of_.pop_back()) pieces_.of_tet[was_of_.back().first] = was_of_.back().second;
  update_pieces(complex_, pieces_, std::span(repair_.changed).subspan(done));
}

void PieceMender::find_open_tissues() {
  const auto components = components_.count_by_tissue(image_.labels.size());
  std::vector<std::uint32_t> pieces(image_.labels.size(), 0);
  for (const auto& piece : pieces_.list) pieces[piece.tissue] += piece.tets > 0;
  open_.assign(image_.labels.size(), 0);
  for (std::size_t t = 1; t < open_.size(); ++t) open_[t] = pieces[t] != 1 || components[t] != 1;
}

// A tetrahedron without a voxel of its tissue stands for the component around its centre, by no voxel.
Claim PieceMender::claim_of(TetId t) const {
  const TissueId own = complex_.tissue(t);
  std::array<Claim, 4> found;  // more than four components in one tetrahedron: the first four
  std::size_t count = 0;
  const auto voxels = contents_.voxels(t);
  constexpr std::size_t kMany = 64;
  for (const std::uint32_t v : voxels) {
    if (image_.voxels[v] != own) continue;
    const std::uint32_t component = components_.of(v);
    std::size_t n = 0;
    while (n < count && found[n].component != component) ++n;
    if (n == found.size()) continue;
    if (n == count) found[count++] = {component, 0, own};
    ++found[n].voxels;
    if (voxels.size() > kMany && contents_.fixed[t]) return {component, static_cast<std::uint32_t>(voxels.size()), own};
  }
  const auto more = [](const Claim& a, const Claim& b) {
    return std::pair(a.voxels, b.component) < std::pair(b.voxels, a.component);
  };
  if (count > 0) return *std::max_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), more);
  const auto voxel = voxel_at(image_, centroid(complex_.mesh, t));
  if (voxel && image_.voxels[*voxel] == own) return {components_.of(*voxel), 0, own};
  return {kNone, 0, own};
}

// Of the tissues that were not open before, and of the tetrahedra relabelled since `done`.
void PieceMender::find_claims(std::size_t done) {
  claimed_.resize(open_.size());
  for (std::size_t i = done; i < repair_.changed.size(); ++i) {
    const TetId t = repair_.changed[i];
    claims_[t] = open_[complex_.tissue(t)] ? claim_of(t) : Claim{};
  }
  if (claimed_ != open_) {
    parallel_for(claims_.size(), [&](std::size_t t) {
      const TissueId tissue = complex_.mesh.tissues[t];
      if (!open_[tissue] || claimed_[tissue] || claims_[t].of == tissue) return;
      claims_[t] = claim_of(static_cast<TetId>(t));
    });
  }
  for (std::size_t t = 0; t < open_.size(); ++t) claimed_[t] = claimed_[t] || open_[t];
}

void PieceMender::list_holdings() {
  holdings_.clear();
  for (TetId t = 0; t < claims_.size(); ++t) {
    const Claim& claim = claims_[t];
    if (claim.component == kNone || !open_[complex_.tissue(t)]) continue;
    const std::uint32_t piece = pieces_.of_tet[t];
    if (holdings_.empty() || !holdings_.back().is_of(piece, claim.component))
      holdings_.push_back({piece, claim.component, 0});
    holdings_.back().voxels += claim.voxels;
  }
  merge_holdings(holdings_);
}

void PieceMender::find_holdings() {
  list_holdings();
  main_.assign(pieces_.list.size(), kNone);
  home_.assign(components_.list().size(), kNone);
  std::vector<std::uint32_t> most_of_piece(main_.size(), 0), most_of_component(home_.size(), 0);
  for (const auto& [piece, component, count] : holdings_) {
    if (main_[piece] == kNone || count > most_of_piece[piece]) {
      main_[piece] = component;
      most_of_piece[piece] = count;
    }
    if (home_[component] == kNone || count > most_of_component[component]) {
      home_[component] = piece;
      most_of_component[component] = count;
    }
  }
  // A component whose home is mainly another's may be at home in a piece of its own elsewhere.
  for (const Holding& h : holdings_) {
    if (main_[home_[h.component]] != h.component && main_[h.piece] == h.component) home_[h.component] = h.piece;
  }
}

std::vector<std::vector<TetId>> PieceMender::tets_of(const std::vector<char>& wanted) const {
  std::vector<std::vector<TetId>> tets(pieces_.list.size());
  if (std::ranges::none_of(wanted, [](char w) { return w; })) return tets;
  for (TetId t = 0; t < pieces_.of_tet.size(); ++t) {
    if (const std::uint32_t piece = pieces_.of_tet[t]; piece != kNone && wanted[piece]) tets[piece].push_back(t);
  }
  return tets;
}

void PieceMender::relabel(TetId t, TissueId tissue, std::uint32_t piece) {
  was_of_.emplace_back(t, pieces_.of_tet[t]);
  complex_.mesh.tissues[t] = tissue;
  pieces_.of_tet[t] = piece;
  locked_[t] = 1;
  repair_.changed.push_back(t);
  for (const VertexId v : complex_.mesh.tets[t]) changed_at_[v] = searches_;
}

// Pieces without a voxel of their tissue go to the neighbour behind most of their faces, unless one is all that its
// component has.
void PieceMender::dissolve_empty_pieces() {
  std::vector<char> empty(pieces_.list.size());
  for (std::size_t p = 0; p < empty.size(); ++p) empty[p] = open_[pieces_.list[p].tissue];
  for (const Holding& h : holdings_) {
    if (h.voxels > 0 || home_[h.component] == h.piece) empty[h.piece] = 0;
  }
  for (const auto& tets : tets_of(empty)) dissolve(tets);
}

// Gives a piece to the neighbour behind most of its faces.
void PieceMender::dissolve(const std::vector<TetId>& tets) {
  const auto is_held = [&](TetId t) { return !contents_.held.empty() && contents_.held[t]; };
  if (std::any_of(tets.begin(), tets.end(), is_held)) return;
  std::map<TissueId, std::uint32_t> faces;
  for (const TetId t : tets) {
    for (const TetId other : complex_.behind[t]) {
      if (complex_.tissue(other) != complex_.tissue(t)) ++faces[complex_.tissue(other)];
    }
  }
  if (faces.empty()) return;
  const auto best = std::max_element(faces.begin(), faces.end(), [](auto& a, auto& b) { return a.second < b.second; });
  for (const TetId t : tets) {
    relabel(t, best->first, kNone);
    locked_[t] = 0;
  }
}

// Where the voxels of components are that no tetrahedron has taken: holdings of tetrahedra, not pieces.
std::vector<Holding> PieceMender::find_absent_components() const {
  std::vector<char> absent(home_.size());
  for (std::size_t c = 0; c < home_.size(); ++c) absent[c] = home_[c] == kNone && open_[components_.list()[c].tissue];
  std::vector<Holding> found;
  if (std::ranges::none_of(absent, [](char a) { return a; })) return found;
  for (const auto& run : components_.runs()) {
    for (std::uint32_t v = run.begin; absent[run.component] && v < run.end; ++v) {
      if (const TetId t = contents_.holder(v); t != TetComplex::kNone) found.push_back({t, run.component, 1});
    }
  }
  merge_holdings(found);
  return found;
}

void PieceMender::seed_absent_components() {
  struct Seed {
    double price = kTooDear;
    TetId tet = 0;
  };
  std::map<std::uint32_t, Seed> seeds;
  for (const auto& [t, component, voxels] : find_absent_components()) {
    Seed& seed = seeds[component];
    if (wants_refinement(t, kSeedSize)) continue;
    if (touches_other_component(t, component)) {
      wants_refinement(t, kTightSize / 4);
      continue;
    }
    const double price = price_(t, components_.list()[component].tissue) - voxels;
    if (price < seed.price) seed = {price, t};
  }
  for (const auto& [component, seed] : seeds) {
    if (seed.price < kTooDear) relabel(seed.tet, components_.list()[component].tissue, kNone);
  }
}

// Whether a tetrahedron has a face toward a piece of another component of the same tissue.
bool PieceMender::touches_other_component(TetId t, std::uint32_t component) const {
  const TissueId tissue = components_.list()[component].tissue;
  return std::any_of(complex_.behind[t].begin(), complex_.behind[t].end(), [&](TetId other) {
    return other != t && complex_.tissue(other) == tissue && main_of(other) != component;
  });
}

void PieceMender::cut_shared_pieces() {
  std::vector<char> shared(pieces_.list.size());
  for (std::uint32_t c = 0; c < home_.size(); ++c) {
    if (home_[c] == kNone || main_[home_[c]] == c) continue;
    shared[home_[c]] = 1;
  }
  for (const auto& tets : tets_of(shared)) {
    if (!tets.empty()) cut(tets);
  }
}

// Grows the components that are at home in a piece until they meet, and cuts there.
void PieceMender::cut(const std::vector<TetId>& tets) {
  const std::uint32_t piece = pieces_.of_tet[tets.front()];
  region_.resize(complex_.mesh.tets.size(), kNone);
  std::vector<TetId> front;
  for (const TetId t : tets) {
    const std::uint32_t c = claims_[t].component;
    if (c == kNone || home_[c] != piece || claims_[t].voxels == 0) continue;
    region_[t] = c;
    front.push_back(t);
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (const TetId other : complex_.behind[front[i]]) {
      if (pieces_.of_tet[other] != piece || region_[other] != kNone) continue;
      region_[other] = region_[front[i]];
      front.push_back(other);
    }
  }
  for (const TetId t : tets) {
    if (region_[t] == kNone) continue;
    for (const TetId other : complex_.behind[t]) {
      if (other < t && pieces_.of_tet[other] == piece && pieces_.of_tet[t] == piece && region_[other] != region_[t])
        cut_face(other, t);
    }
  }
  for (const TetId t : front) region_[t] = kNone;
}

// One of two tetrahedra that join two components gets another tissue: the one with fewer voxels of its own.
void PieceMender::cut_face(TetId a, TetId b) {
  const TetId t =
      std::tuple(claims_[a].voxels, contents_.sizes[a], a) <= std::tuple(claims_[b].voxels, contents_.sizes[b], b) ? a
                                                                                                                   : b;
  if (wants_refinement(t, claims_[t].voxels > 0 ? kTightSize : kCutSize)) {
    wants_refinement(t == a ? b : a, kCutSize);
    return;
  }
  if (!contents_.fixed[t]) relabel(t, other_tissue(t), kNone);
}

// What a tetrahedron holds most of besides its own tissue; else what lies behind it: a piece of its own without a voxel
// would be dissolved again. Else what its centre lies in.
TissueId PieceMender::other_tissue(TetId t) const {
  const TissueId own = complex_.tissue(t);
  std::map<TissueId, std::uint32_t> votes;
  const auto vote = [&](TissueId tissue) {
    if (tissue != own) ++votes[tissue];
  };
  for (const std::uint32_t v : contents_.voxels(t)) vote(image_.voxels[v]);
  if (votes.empty()) {
    for (const TetId other : complex_.behind[t]) vote(complex_.tissue(other));
  }
  if (votes.empty()) {
    if (const auto voxel = voxel_at(image_, centroid(complex_.mesh, t))) vote(image_.voxels[*voxel]);
  }
  if (votes.empty()) return 0;
  return std::max_element(votes.begin(), votes.end(), [](auto& a, auto& b) { return a.second < b.second; })->first;
}

void PieceMender::join_pieces() {
  std::vector<std::uint32_t> pieces_of(components_.list().size(), 0);
  for (std::size_t p = 0; p < main_.size(); ++p) {
    if (main_[p] != kNone && pieces_.list[p].tets > 0) ++pieces_of[main_[p]];
  }
  std::vector<char> scattered(pieces_.list.size());
  for (std::uint32_t p = 0; p < main_.size(); ++p)
    scattered[p] = main_[p] != kNone && pieces_of[main_[p]] > 1 && home_[main_[p]] != p;
  const auto tets = tets_of(scattered);
  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < tets.size(); ++p) {
    if (!tets[p].empty()) order.push_back(p);
  }
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return tets[a].size() < tets[b].size(); });
  DisjointSets joined(pieces_.list.size());
  for (const std::uint32_t p : order) join_piece(p, tets[p], joined);
}

// What it costs, in voxels, to lead a path of a tissue through a tetrahedron of another, without what it costs to split
// that. One that will be refined first counts by its width, less where it holds voxels of the tissue.
double PieceMender::path_cost(TetId t, TissueId tissue) const {
  constexpr double kLocked = 8;
  const auto size = static_cast<double>(contents_.sizes[t]);
  if (refines_first(t)) {
    const auto voxels = contents_.voxels(t);
    const bool leads_there =
        std::any_of(voxels.begin(), voxels.end(), [&](auto v) { return image_.voxels[v] == tissue; });
    return leads_there ? 0.5 : 1 + std::cbrt(size);
  }
  return price_(t, tissue) + 0.2 * size + 0.05 + (locked_[t] ? kLocked : 0);
}

double PieceMender::split_cost(TetId t) const {
  constexpr double kSplits = 5;
  return complex_.tissue(t) == 0 || refines_first(t) || neighbours_hang_together(complex_, t) ? 0 : kSplits;
}

// Whether a path through a tetrahedron waits until it has been refined.
bool PieceMender::refines_first(TetId t) const {
  return contents_.may_refine[t] && (contents_.fixed[t] || contents_.sizes[t] > kPathSize);
}

// Dijkstra's algorithm from a piece to the nearest other piece of the same component. Whether a path splits what it
// leads through takes long to find out: a step waits in the queue without that cost until it is its turn.
std::optional<PieceMender::Way> PieceMender::find_way(std::uint32_t piece, const std::vector<TetId>& tets,
                                                      DisjointSets& joined) {
  constexpr double kReach = 40;
  constexpr std::size_t kMaxVisited = 100000;
  const TissueId tissue = pieces_.list[piece].tissue;
  const std::uint32_t component = main_[piece];
  struct Step {
    double cost;
    TetId tet, from;
    bool is_whole = true;  // its cost has that of splitting in it
    bool operator>(const Step& o) const { return std::tie(cost, tet) > std::tie(o.cost, o.tet); }
  };
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  known_.clear();
  for (const TetId t : tets) {
    if (complex_.tissue(t) == tissue) open.push({0, t, t});  // another path may have taken it
  }
  for (std::size_t visited = 0; !open.empty() && visited < kMaxVisited;) {
    const Step step = open.top();
    open.pop();
    Known& here = known_[step.tet];
    if (here.reached) continue;
    if (!step.is_whole) {
      if (here.split_cost < 0) here.split_cost = split_cost(step.tet);
      if (here.split_cost > 0) {
        if (const double cost = step.cost + here.split_cost; cost < kReach) open.push({cost, step.tet, step.from});
        continue;
      }
    }
    here.reached = true;
    here.from = step.from;
    ++visited;
    if (complex_.tissue(step.tet) == tissue && pieces_.of_tet[step.tet] != kNone &&
        joined.root(pieces_.of_tet[step.tet]) != joined.root(piece))
      return Way{step.from, step.tet};
    for (const TetId other : complex_.behind[step.tet]) {
      if (complex_.tissue(other) == tissue) {
        if (main_of(other) == component && !known_[other].reached) open.push({step.cost, other, step.tet});
        continue;
      }
      Known& there = known_[other];
      if (there.reached) continue;
      if (there.cost < 0) there.cost = touches_other_component(other, component) ? kReach : path_cost(other, tissue);
      if (step.cost + there.cost < kReach) open.push({step.cost + there.cost, other, step.tet, false});
    }
  }
  return {};
}

void PieceMender::join_piece(std::uint32_t piece, const std::vector<TetId>& tets, DisjointSets& joined) {
  ++searches_;
  if (const auto vain = vain_.find(tets.front()); vain != vain_.end() && holds_still(vain->second, piece, tets)) {
    repair_.refine.insert(repair_.refine.end(), vain->second.wanted.begin(), vain->second.wanted.end());
    return;
  }
  const std::size_t changed = repair_.changed.size(), wanted = repair_.refine.size();
  if (const auto way = find_way(piece, tets, joined)) {
    lay_path(piece, *way, joined);
  } else {
    give_up(piece, tets);
  }
  const TissueId tissue = pieces_.list[piece].tissue;
  const bool was_in_vain = repair_.changed.size() == changed &&
                           std::ranges::all_of(tets, [&](TetId t) { return complex_.tissue(t) == tissue; });
  remembered_ += was_in_vain ? known_.size() : 0;
  if (!was_in_vain || remembered_ > complex_.mesh.tets.size()) return;
  vain_[tets.front()] =
      vain_search(piece, tets, {repair_.refine.begin() + static_cast<std::ptrdiff_t>(wanted), repair_.refine.end()});
}

void PieceMender::lay_path(std::uint32_t piece, const Way& way, DisjointSets& joined) {
  const TissueId tissue = pieces_.list[piece].tissue;
  std::vector<TetId> path;
  for (TetId t = way.last; complex_.tissue(t) != tissue; t = known_[t].from) path.push_back(t);
  bool too_large = false;
  for (const TetId t : path) {
    const float size = contents_.fixed[t] ? 0 : kPathSize;
    too_large = (price_(t, tissue) > 0 && wants_refinement(t, size)) || too_large;
  }
  if (too_large) return;
  for (const TetId t : path) relabel(t, tissue, piece);
  joined.join(piece, pieces_.of_tet[way.reached]);
}

// There is no way for it: where it is no more than a scrap, it goes.
void PieceMender::give_up(std::uint32_t piece, const std::vector<TetId>& tets) {
  constexpr std::size_t kScrap = 64;  // tetrahedra
  const TissueId tissue = pieces_.list[piece].tissue;
  bool too_large = false;
  for (const TetId t : tets) too_large = wants_refinement(t, kPathSize) || too_large;
  const bool untouched = std::ranges::all_of(tets, [&](TetId t) { return complex_.tissue(t) == tissue; });
  if (!too_large && untouched && tets.size() <= kScrap) dissolve(tets);
}

// What the last search looked at.
PieceMender::VainSearch PieceMender::vain_search(std::uint32_t piece, const std::vector<TetId>& tets,
                                                 std::vector<TetId> wanted) const {
  VainSearch search{main_[piece], searches_, tets.size(), {}, {}, std::move(wanted)};
  const TissueId tissue = pieces_.list[piece].tissue;
  known_.for_each([&](TetId t) {
    search.seen.push_back(t);
    for (const TetId other : complex_.behind[t]) {
      if (complex_.tissue(other) == tissue) search.mains.emplace_back(other, main_of(other));
    }
  });
  return search;
}

bool PieceMender::holds_still(const VainSearch& search, std::uint32_t piece, const std::vector<TetId>& tets) const {
  const auto is_as_it_was = [&](TetId t) {
    return std::ranges::all_of(complex_.mesh.tets[t], [&](VertexId v) { return changed_at_[v] < search.number; });
  };
  return search.component == main_[piece] && search.tets == tets.size() &&
         std::ranges::all_of(search.seen, is_as_it_was) &&
         std::ranges::all_of(search.mains, [&](const auto& main) { return main_of(main.first) == main.second; });
}

}  // namespace

std::optional<std::uint32_t> voxel_at(const TissueImage& image, Vec3 point_mm) {
  const auto [i, j, k] = image.index_at(point_mm);
  if (!image.contains(i, j, k)) return std::nullopt;
  return static_cast<std::uint32_t>(image.offset(i, j, k));
}

RelabelPrice voxel_price(const TetComplex& complex, const TissueImage& image, const TetContents& contents) {
  return [&complex, &image, &contents](TetId t, TissueId tissue) {
    if (contents.fixed[t]) return 2 * kTooDear;
    double price = 0;
    for (const std::uint32_t v : contents.voxels(t)) {
      price += image.voxels[v] == complex.tissue(t);
      price -= image.voxels[v] == tissue;
    }
    return std::max(0.0, price);
  };
}

PieceRepair mend_pieces(TetComplex& complex, Pieces& pieces, const TissueImage& image,
                        const ImageComponents& components, const TetContents& contents, std::vector<Claim>& claims) {
  claims.resize(complex.mesh.tets.size());
  return PieceMender(complex, pieces, image, components, contents, claims).run();
}

}  // namespace anatomesh
