#include "lattice/label_lattice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "base/parallel.h"
#include "base/vec.h"
#include "lattice/clean_labels.h"
#include "lattice/red_green.h"
#include "lattice/voxel_votes.h"

namespace anatomesh {
namespace {

// Places in the arrays of a level are 32-bit numbers.
constexpr double kMaxRootTets = 2e9;

// Where the lattice lies over the image.
struct Placement {
  std::array<std::int32_t, 3> cells;
  Vec3 origin_mm;
  double unit_mm;
};

// Cubes that cover the labelled voxels with one to spare on every side, centred on them.
Placement place_lattice(const TissueImage& image, const LatticePlan& plan) {
  Placement place;
  place.unit_mm = plan.bcc_size_mm / 4;
  for (std::size_t a = 0; a < 3; ++a) {
    const double voxels = image.size[a] - 2 * TissueImage::kBorder;
    const double extent = voxels * image.spacing_mm[a];
    const double cells = std::ceil(extent / plan.bcc_size_mm) + 2;
    if (cells * 4 * std::ldexp(1.0, plan.levels) > LatticePointMap::kMaxCoordinate) {
      throw InvalidInput("a lattice of " + std::to_string(plan.bcc_size_mm) + " mm over " + std::to_string(extent) +
                         " mm of image is too large; take a larger bcc_size or min_size");
    }
    place.cells[a] = static_cast<std::int32_t>(cells) + 1;  // the last cell has the far half of its neighbours only
    const double low = (static_cast<double>(image.first[a] + TissueImage::kBorder) - 0.5) * image.spacing_mm[a];
    place.origin_mm[a] = low + 0.5 * extent - 0.5 * cells * plan.bcc_size_mm;
  }
  const double tets = 12.0 * place.cells[0] * place.cells[1] * place.cells[2];
  if (tets > kMaxRootTets) {
    throw InvalidInput("a lattice of " + std::to_string(plan.bcc_size_mm) + " mm over this image has " +
                       std::to_string(tets) + " tetrahedra before refinement; take a larger bcc_size");
  }
  return place;
}

// As many of the extra levels as the lattice's coordinates allow.
int deepest_level(const Placement& place, const LatticePlan& plan) {
  const double widest = *std::max_element(place.cells.begin(), place.cells.end());
  int level = plan.levels + plan.extra_levels;
  while (level > plan.levels && widest * 4 * std::ldexp(1.0, level) > LatticePointMap::kMaxCoordinate) --level;
  return level;
}

// A leaf and the votes of its parts: one, or those of its green split.
struct VotedLeaf {
  TetRef tet;
  std::array<Vote, 4> votes;
};

// What a tissue asks of the tetrahedra that hold its voxels.
struct Demand {
  int level_limit = 0;  // its boundary is refined in tetrahedra above this level; 0: not at all
  bool absent = false;  // no tetrahedron has taken it yet
  bool thin = false;    // the volume of its tetrahedra is far from that of its voxels: it lies between their centres
};

}  // namespace

class LabelLattice::Impl {
 public:
  Impl(const TissueImage& image, const LatticePlan& plan)
      : image_(image),
        plan_(plan),
        target_(plan.fidelity),
        place_(place_lattice(image, plan)),
        lattice_(place_.cells, deepest_level(place_, plan)),
        votes_(image, lattice_, place_.origin_mm, place_.unit_mm) {}

  LabelledLattice build(const Stage& stage);
  std::optional<LabelledLattice> refine(const FidelityGap& gap, const Stage& stage);

 private:
  /// Returns whether anything was refined.
  bool refine_until_faithful(const Stage& stage);
  std::vector<TetRef> leaves_to_mend(const FidelityGap& gap) const;
  LabelledLattice extract(const Stage& stage) const;
  void raise_targets(const std::vector<LatticeFidelity>& reached);
  void collect_leaves();
  std::vector<LatticeFidelity> inherited_fidelity() const;
  std::vector<Demand> demands() const;
  bool wants_refinement(TetRef leaf, const std::vector<Demand>& demands) const;
  template <class Visit>
  void visit_parts(const VotedLeaf& leaf, const Visit& visit) const;

  const TissueImage& image_;
  const LatticePlan& plan_;
  std::vector<double> target_;  // fidelity to reach before the removal of label noise, by tissue
  Placement place_;
  RedGreenLattice lattice_;
  VoxelVotes votes_;
  std::vector<VotedLeaf> leaves_;
  int rounds_done_ = 0;
};

// Calls visit(vote, nodes, part) for a leaf, or for each of its green parts.
template <class Visit>
void LabelLattice::Impl::visit_parts(const VotedLeaf& leaf, const Visit& visit) const {
  const GreenSplit& split = green_split(lattice_.split_edges(leaf.tet));
  for (std::size_t c = 0; c < static_cast<std::size_t>(split.count); ++c) visit(leaf.votes[c], split.tets[c], c);
}

void LabelLattice::Impl::collect_leaves() {
  leaves_.clear();
  for (int level = 0; level <= lattice_.max_level(); ++level) {
    for (std::uint32_t slot = 0; slot < lattice_.slot_count(level); ++slot) {
      if (lattice_.is_leaf({level, slot})) leaves_.push_back({{level, slot}, {}});
    }
  }
  parallel_for(leaves_.size(), [&](std::size_t i) {
    VotedLeaf& leaf = leaves_[i];
    if (lattice_.split_edges(leaf.tet) == 0) {
      leaf.votes[0] = votes_.vote(leaf.tet);
    } else {
      leaf.votes = votes_.green_votes(leaf.tet);
    }
  });
}

// Voxels of the pure tetrahedra that handed their label down without counting.
std::vector<LatticeFidelity> LabelLattice::Impl::inherited_fidelity() const {
  std::vector<LatticeFidelity> fidelity(image_.labels.size());
  for (std::size_t t = 0; t < fidelity.size(); ++t) fidelity[t].voxels = image_.counts[t];
  for (int level = 0; level < lattice_.max_level(); ++level) {
    for (std::uint32_t slot = 0; slot < lattice_.slot_count(level); ++slot) {
      const TetRef t = {level, slot};
      if (!lattice_.exists(t) || !lattice_.is_refined(t) || !votes_.hands_label_down(t)) continue;
      fidelity[votes_.vote(t).tissue].in_tets += votes_.vote(t).count;
      fidelity[votes_.vote(t).tissue].hits += votes_.vote(t).hits;
    }
  }
  return fidelity;
}

namespace {

// A tissue this far below its fidelity at the smallest size is thinner than it: it gets one level more.
constexpr double kFarShort = 0.15;
// So does one whose volume is off by this share more than 1 - F, and one more at twice of it. Where a tissue is one
// voxel thick, voxel centres alone would call the lattice faithful.
constexpr double kFarOff = 0.25;

}  // namespace

std::vector<Demand> LabelLattice::Impl::demands() const {
  std::vector<LatticeFidelity> fidelity = inherited_fidelity();
  std::vector<Demand> demands(fidelity.size(), {0, true, false});
  std::vector<double> volume_mm3(fidelity.size(), 0);
  for (const VotedLeaf& leaf : leaves_) {
    const double h = std::ldexp(plan_.bcc_size_mm, -leaf.tet.level);
    const double part_mm3 = h * h * h / 12 / green_split(lattice_.split_edges(leaf.tet)).count;
    visit_parts(leaf, [&](const Vote& v, const auto&, std::size_t) {
      volume_mm3[v.tissue] += part_mm3;
      fidelity[v.tissue].in_tets += v.count;
      fidelity[v.tissue].hits += v.hits;
      demands[v.tissue].absent = false;
    });
  }
  demands[0].absent = false;
  for (std::size_t t = 1; t < demands.size(); ++t) {
    const LatticeFidelity& f = fidelity[t];
    if (f.f1() < target_[t] || f.f2() < target_[t]) demands[t].level_limit = plan_.levels;
    if (std::min(f.f1(), f.f2()) < plan_.fidelity[t] - kFarShort)
      demands[t].level_limit = std::min(plan_.levels + 1, lattice_.max_level());
    const Vec3 s = image_.spacing_mm;
    const double off = std::abs(volume_mm3[t] / (static_cast<double>(image_.counts[t]) * s.x * s.y * s.z) - 1);
    const double far_off = kFarOff + 1 - plan_.fidelity[t];
    demands[t].thin = off > far_off;
    if (demands[t].thin)
      demands[t].level_limit = std::min(plan_.levels + (off > 2 * far_off ? 2 : 1), lattice_.max_level());
    if (demands[t].absent) demands[t].level_limit = lattice_.max_level();
  }
  return demands;
}

// A leaf is refined when the boundary of a tissue that falls short passes between its voxels, or when it holds
// a voxel of a tissue that no tetrahedron has taken yet or that is too thin to show between voxel centres.
bool LabelLattice::Impl::wants_refinement(TetRef leaf, const std::vector<Demand>& demands) const {
  const auto voxels = votes_.voxels(leaf);
  if (voxels.empty()) return false;
  const TissueId first = image_.voxels[voxels[0]];
  bool mixed = false, holds_hidden = false;
  int limit = 0;
  for (const std::uint32_t v : voxels) {
    const Demand& demand = demands[image_.voxels[v]];
    mixed = mixed || image_.voxels[v] != first;
    holds_hidden = holds_hidden || demand.absent || (demand.thin && voxels.size() < VoxelVotes::kQuorum);
    limit = std::max(limit, demand.level_limit);
  }
  return (mixed || holds_hidden) && leaf.level < limit;
}

bool LabelLattice::Impl::refine_until_faithful(const Stage& stage) {
  for (int round = 0;; ++round) {
    collect_leaves();
    stage.check_cancelled();
    const std::vector<Demand> asked = demands();
    std::vector<char> wanted(leaves_.size());
    parallel_for(leaves_.size(), [&](std::size_t i) { wanted[i] = wants_refinement(leaves_[i].tet, asked); });
    std::vector<TetRef> marked;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      if (wanted[i]) marked.push_back(leaves_[i].tet);
    }
    if (marked.empty()) return round > 0;
    stage.check_cancelled();
    votes_.descend(lattice_.refine(marked));
    stage.at(std::min(0.9, 0.15 + 0.1 * ++rounds_done_));
  }
}

// What the removal of label noise took from a tissue is asked for on top.
void LabelLattice::Impl::raise_targets(const std::vector<LatticeFidelity>& reached) {
  constexpr double kMargin = 0.01;
  for (std::size_t t = 1; t < target_.size(); ++t) {
    const double lacking = plan_.fidelity[t] - std::min(reached[t].f1(), reached[t].f2());
    if (lacking > 0) target_[t] = std::min(1.0, target_[t] + lacking + kMargin);
  }
}

namespace {

// Nodes 0 .. 9 of a leaf (vertices, edge midpoints), in units of the finest level.
std::array<LatticePoint, 10> leaf_nodes(const RedGreenLattice& lattice, TetRef leaf) {
  const LatticePoint b = lattice.barycentre(leaf);
  std::array<LatticePoint, 10> nodes;
  const auto vertices = bcc_vertices(b);
  std::copy(vertices.begin(), vertices.end(), nodes.begin());
  for (int e = 0; e < 6; ++e) nodes[static_cast<std::size_t>(4 + e)] = bcc_edge_midpoint(b, e);
  for (LatticePoint& node : nodes) {
    for (std::int32_t& c : node) c *= 1 << (lattice.max_level() - leaf.level);
  }
  return nodes;
}

// Where a tetrahedron of the mesh comes from.
struct Origin {
  TetRef leaf;
  std::uint32_t part;
  Vote vote;
};

// Tetrahedra of the lattice, with numbered vertices.
struct Extraction {
  TissueMesh mesh;
  std::vector<Origin> origins;  // one a tetrahedron
  LatticePointMap vertices;

  void add(const std::array<LatticePoint, 10>& nodes, const std::array<std::uint8_t, 4>& corners, bool positive,
           const Origin& origin) {
    std::array<VertexId, 4> tet;
    for (std::size_t n = 0; n < 4; ++n) tet[n] = vertices.insert(nodes[corners[n]]);
    if (!positive) std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
    mesh.tissues.push_back(origin.vote.tissue);
    origins.push_back(origin);
  }
};

}  // namespace

LabelledLattice LabelLattice::Impl::extract(const Stage& stage) const {
  Extraction taken;
  std::uint32_t tissue_vertices = 0;
  for (const bool cushion : {false, true}) {
    for (const VotedLeaf& leaf : leaves_) {
      const auto nodes = leaf_nodes(lattice_, leaf.tet);
      const bool positive = is_positive(lattice_.barycentre(leaf.tet));
      visit_parts(leaf, [&](const Vote& v, const auto& corners, std::size_t part) {
        const auto on_tissue = [&](std::uint8_t n) { return taken.vertices.find(nodes[n]) < tissue_vertices; };
        if ((v.tissue == 0) != cushion) return;
        if (cushion && std::none_of(corners.begin(), corners.end(), on_tissue)) return;
        taken.add(nodes, corners, positive, {leaf.tet, static_cast<std::uint32_t>(part), v});
      });
    }
    stage.check_cancelled();
    if (!cushion) tissue_vertices = static_cast<std::uint32_t>(taken.vertices.points().size());
  }
  const double fine_unit = place_.unit_mm / static_cast<double>(1 << lattice_.max_level());
  for (const LatticePoint& p : taken.vertices.points()) {
    taken.mesh.points_mm.push_back(place_.origin_mm + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]});
  }
  const auto has_weak_vote = [&](TetId t) {
    const Origin& origin = taken.origins[t];
    return !votes_.hands_label_down(origin.leaf) && origin.vote.hits < VoxelVotes::kQuorum / 2;
  };
  clean_labels(taken.mesh, has_weak_vote);
  stage.check_cancelled();

  LabelledLattice result;
  result.fidelity = inherited_fidelity();
  for (std::size_t t = 0; t < taken.origins.size(); ++t) {
    const Origin& origin = taken.origins[t];
    const TissueId tissue = taken.mesh.tissues[t];
    const bool kept = tissue == origin.vote.tissue;
    result.fidelity[tissue].in_tets += origin.vote.count;
    result.fidelity[tissue].hits += kept ? origin.vote.hits : votes_.voxels_of(origin.leaf, origin.part, tissue);
  }
  result.mesh = with_cushion_last(taken.mesh);
  return result;
}

LabelledLattice LabelLattice::Impl::build(const Stage& stage) {
  constexpr int kAttempts = 3;
  stage.at(0.15);
  LabelledLattice result;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (!refine_until_faithful(stage) && attempt > 0) break;
    stage.check_cancelled();
    result = extract(stage);
    raise_targets(result.fidelity);
  }
  stage.at(1);
  return result;
}

// The leaves with most wrong voxels first, until those taken hold as many as each tissue has to mend.
std::vector<TetRef> LabelLattice::Impl::leaves_to_mend(const FidelityGap& gap) const {
  std::vector<std::uint32_t> wrong(leaves_.size(), 0);
  parallel_for(leaves_.size(), [&](std::size_t i) {
    if (leaves_[i].tet.level >= lattice_.max_level()) return;
    for (const std::uint32_t v : votes_.voxels(leaves_[i].tet)) wrong[i] += gap.wrong[v] != 0;
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < leaves_.size(); ++i) {
    if (wrong[i] > 0) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::greater<>(), [&](std::uint32_t i) { return wrong[i]; });
  std::vector<std::uint64_t> open = gap.to_mend;
  std::vector<TetRef> marked;
  for (const std::uint32_t i : order) {
    bool wanted = false;
    for (const std::uint32_t v : votes_.voxels(leaves_[i].tet)) {
      const TissueId t = gap.wrong[v];
      if (t == 0 || open[t] == 0 || leaves_[i].tet.level >= plan_.levels) continue;
      --open[t];
      wanted = true;
    }
    if (wanted) marked.push_back(leaves_[i].tet);
  }
  return marked;
}

std::optional<LabelledLattice> LabelLattice::Impl::refine(const FidelityGap& gap, const Stage& stage) {
  const std::vector<TetRef> marked = leaves_to_mend(gap);
  if (marked.empty()) return std::nullopt;
  votes_.descend(lattice_.refine(marked));
  collect_leaves();
  stage.check_cancelled();
  return extract(stage);
}

LabelLattice::LabelLattice(const TissueImage& image, const LatticePlan& plan)
    : impl_(std::make_unique<Impl>(image, plan)) {}
LabelLattice::~LabelLattice() = default;
LabelledLattice LabelLattice::build(const Stage& stage) { return impl_->build(stage); }
std::optional<LabelledLattice> LabelLattice::refine(const FidelityGap& gap, const Stage& stage) {
  return impl_->refine(gap, stage);
}

}  // namespace anatomesh
