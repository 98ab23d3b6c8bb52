#include "lattice/label_lattice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "base/parallel.h"
#include "base/vec.h"
#include "image/components.h"
#include "lattice/labelled_leaves.h"
#include "lattice/leaf_mesh.h"
#include "lattice/mend_lattice.h"
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

// Levels below the deepest one where a surface may be mended.
constexpr int kMendLevels = 3;

// As many of the extra levels as the lattice's coordinates allow.
int deepest_level(const Placement& place, const LatticePlan& plan, int extra_levels) {
  const double widest = *std::max_element(place.cells.begin(), place.cells.end());
  int level = plan.levels + extra_levels;
  while (level > plan.levels && widest * 4 * std::ldexp(1.0, level) > LatticePointMap::kMaxCoordinate) --level;
  return level;
}

// What a tissue asks of the tetrahedra that hold its voxels.
struct Demand {
  int level_limit = 0;  // its boundary is refined in tetrahedra above this level; 0: not at all
  bool absent = false;  // no tetrahedron has taken it yet
  bool thin = false;    // the volume of its tetrahedra is far from that of its voxels: it lies between their centres

  bool exceeds(const Demand& o) const {
    return level_limit > o.level_limit || (absent && !o.absent) || (thin && !o.thin);
  }
};

}  // namespace

class LabelLattice::Impl {
 public:
  Impl(const TissueImage& image, const LatticePlan& plan)
      : image_(image),
        plan_(plan),
        target_(plan.fidelity),
        place_(place_lattice(image, plan)),
        deepest_(deepest_level(place_, plan, plan.extra_levels)),
        lattice_(place_.cells, deepest_level(place_, plan, plan.extra_levels + kMendLevels)),
        votes_(image, lattice_, place_.origin_mm, place_.unit_mm),
        leaves_(lattice_, votes_),
        mesher_(lattice_, votes_, place_.origin_mm, place_.unit_mm),
        components_(image) {}

  LabelledLattice build(const Stage& stage);
  std::optional<LabelledLattice> refine(const FidelityGap& gap, const Stage& stage);
  TissueMesh background() const;

 private:
  bool has_room_for(const std::vector<TetRef>& marked) const;
  std::vector<TetRef> leaves_wanted(const std::vector<Demand>& asked) const;
  /// Returns whether anything was refined.
  bool refine_until_faithful(const Stage& stage);
  std::vector<TetRef> leaves_to_mend(const FidelityGap& gap) const;
  std::vector<TetRef> leaves_that_miss(const std::vector<char>& missed, double fine_mm) const;
  LabelledLattice make_whole(const Stage& stage);
  MendPlan mend_plan() const { return {place_.unit_mm, deepest_, !plan_.allow_non_manifold}; }
  void raise_targets(const std::vector<Fidelity>& reached);
  std::vector<Fidelity> inherited_fidelity() const;
  std::vector<Fidelity> fidelity() const;
  std::vector<Demand> demands() const;
  bool is_too_large(TetRef leaf) const;
  bool lies_on_boundary(TetRef leaf, const std::vector<Demand>& demands) const;
  template <class Visit>
  void visit_parts(const LabelledLeaf& leaf, const Visit& visit) const;

  const TissueImage& image_;
  const LatticePlan& plan_;
  std::vector<double> target_;  // fidelity to reach before the removal of label noise, by tissue
  std::vector<Demand> asked_;   // by tissue, in the round before; empty in the first
  Placement place_;
  int deepest_;  // level for tissues and pieces; surfaces may be mended below it
  RedGreenLattice lattice_;
  VoxelVotes votes_;
  LabelledLeaves leaves_;
  LeafMesher mesher_;
  ImageComponents components_;
  int rounds_done_ = 0;
};

// Calls visit(vote, nodes, part) for a leaf, or for each of its green parts.
template <class Visit>
void LabelLattice::Impl::visit_parts(const LabelledLeaf& leaf, const Visit& visit) const {
  const GreenSplit& split = leaf.split();
  for (std::uint32_t c = 0; c < static_cast<std::uint32_t>(split.count); ++c) visit(leaf.votes[c], split.tets[c], c);
}

// Voxels of the pure tetrahedra that handed their label down without counting.
std::vector<Fidelity> LabelLattice::Impl::inherited_fidelity() const {
  std::vector<Fidelity> fidelity(image_.labels.size());
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
  std::vector<Fidelity> fidelity = inherited_fidelity();
  std::vector<Demand> demands(fidelity.size(), {0, true, false});
  std::vector<double> volume_mm3(fidelity.size(), 0);
  std::vector<double> leaf_mm3;  // by level
  for (int level = 0; level <= lattice_.max_level(); ++level) {
    const double h = std::ldexp(plan_.bcc_size_mm, -level);
    leaf_mm3.push_back(h * h * h / 12);
  }
  for (const LabelledLeaf& leaf : leaves_.list()) {
    const double part_mm3 = leaf_mm3[static_cast<std::size_t>(leaf.tet.level)] / leaf.split().count;
    visit_parts(leaf, [&](const Vote& v, const auto&, std::uint32_t) {
      volume_mm3[v.tissue] += part_mm3;
      fidelity[v.tissue].in_tets += v.count;
      fidelity[v.tissue].hits += v.hits;
      demands[v.tissue].absent = false;
    });
  }
  demands[0].absent = false;
  for (std::size_t t = 1; t < demands.size(); ++t) {
    const Fidelity& f = fidelity[t];
    if (!plan_.surface_level.empty()) demands[t].level_limit = plan_.surface_level[t];
    if (f.f1() < target_[t] || f.f2() < target_[t]) demands[t].level_limit = plan_.levels;
    if (std::min(f.f1(), f.f2()) < plan_.fidelity[t] - kFarShort)
      demands[t].level_limit = std::min(plan_.levels + 1, deepest_);
    const double off = std::abs(volume_mm3[t] / image_.volume_mm3(t) - 1);
    const double far_off = kFarOff + 1 - plan_.fidelity[t];
    demands[t].thin = off > far_off;
    if (demands[t].thin) demands[t].level_limit = std::min(plan_.levels + (off > 2 * far_off ? 2 : 1), deepest_);
    if (demands[t].absent) demands[t].level_limit = deepest_;
  }
  return demands;
}

bool LabelLattice::Impl::is_too_large(TetRef leaf) const {
  if (plan_.sizes == nullptr || leaf.level >= deepest_) return false;
  const double edge = std::ldexp(plan_.bcc_size_mm, -leaf.level);
  const auto voxels = votes_.voxels(leaf);
  if (std::ranges::any_of(voxels, [&](std::uint32_t v) { return edge > plan_.sizes->at_voxel(v); })) return true;
  const LatticePoint b = lattice_.barycentre(leaf);
  const double unit = std::ldexp(place_.unit_mm, -leaf.level);
  const Vec3 middle = place_.origin_mm + Vec3{unit * b[0], unit * b[1], unit * b[2]};
  return edge > plan_.sizes->at(votes_.vote(leaf).tissue, middle);
}

// A leaf is refined when the boundary of a tissue that falls short passes between its voxels, or between the corners of
// one with few voxels, or when it holds a voxel of a tissue that no tetrahedron has taken yet or that is too thin to
// show between voxel centres.
bool LabelLattice::Impl::lies_on_boundary(TetRef leaf, const std::vector<Demand>& demands) const {
  if (votes_.hands_label_down(leaf)) return false;
  const auto voxels = votes_.voxels(leaf);
  const bool is_small = voxels.size() < VoxelVotes::kQuorum;
  const Vote& vote = votes_.vote(leaf);
  bool mixed = false, holds_hidden = false, may_go_deeper = false;
  const auto meet = [&](TissueId tissue) {
    mixed = mixed || tissue != vote.tissue;
    may_go_deeper = may_go_deeper || leaf.level < demands[tissue].level_limit;
  };
  const auto meet_voxel_of = [&](TissueId tissue) {
    holds_hidden = holds_hidden || demands[tissue].absent || (demands[tissue].thin && is_small);
    meet(tissue);
  };
  meet(vote.tissue);
  if (vote.pure && !voxels.empty()) {
    meet_voxel_of(vote.tissue);
  } else {
    for (const std::uint32_t v : voxels) {
      meet_voxel_of(image_.voxels[v]);
      if (mixed && may_go_deeper) return true;
    }
  }
  if (is_small) std::ranges::for_each(votes_.tissues_at_corners(leaf), meet);
  return (mixed || holds_hidden) && may_go_deeper;
}

// Leaves that were passed over before are not looked at again while no tissue asks for more.
std::vector<TetRef> LabelLattice::Impl::leaves_wanted(const std::vector<Demand>& asked) const {
  const bool any_asks_for_more =
      asked_.empty() ||
      !std::ranges::equal(asked, asked_, [](const Demand& now, const Demand& before) { return !now.exceeds(before); });
  const int deepest_asked = std::ranges::max(asked, {}, &Demand::level_limit).level_limit;
  std::vector<char> wanted(leaves_.list().size());
  parallel_for(leaves_.list().size(), [&](std::size_t i) {
    const LabelledLeaf& leaf = leaves_.list()[i];
    if (!leaf.fresh && !any_asks_for_more) return;
    wanted[i] = is_too_large(leaf.tet) || (leaf.tet.level < deepest_asked && lies_on_boundary(leaf.tet, asked));
  });
  std::vector<TetRef> marked;
  for (std::size_t i = 0; i < leaves_.list().size(); ++i) {
    if (wanted[i]) marked.push_back(leaves_.list()[i].tet);
  }
  return marked;
}

// Eight take the place of each of them.
bool LabelLattice::Impl::has_room_for(const std::vector<TetRef>& marked) const {
  return leaves_.list().size() + 7 * marked.size() <= plan_.most_tets;
}

bool LabelLattice::Impl::refine_until_faithful(const Stage& stage) {
  asked_.clear();
  for (int round = 0;; ++round) {
    leaves_.collect(NewLabels::vote);
    stage.check_cancelled();
    std::vector<Demand> asked = demands();
    const std::vector<TetRef> marked = leaves_wanted(asked);
    asked_ = std::move(asked);
    if (marked.empty()) return round > 0;
    if (!has_room_for(marked)) {
      throw InvalidInput("the lattice needs more than the " + std::to_string(plan_.most_tets) +
                         " tetrahedra that fit into the memory; take a larger bcc_size, min_size or "
                         "max_memory_gib");
    }
    stage.check_cancelled();
    votes_.descend(lattice_.refine(marked));
    stage.at(std::min(0.9, 0.15 + 0.1 * ++rounds_done_));
  }
}

// What the removal of label noise took from a tissue is asked for on top.
void LabelLattice::Impl::raise_targets(const std::vector<Fidelity>& reached) {
  constexpr double kMargin = 0.01;
  for (std::size_t t = 1; t < target_.size(); ++t) {
    const double lacking = plan_.fidelity[t] - std::min(reached[t].f1(), reached[t].f2());
    if (lacking > 0) target_[t] = std::min(1.0, target_[t] + lacking + kMargin);
  }
}

std::vector<Fidelity> LabelLattice::Impl::fidelity() const {
  std::vector<Fidelity> fidelity = inherited_fidelity();
  for (const LabelledLeaf& leaf : leaves_.list()) {
    visit_parts(leaf, [&](const Vote& v, const auto&, std::uint32_t) {
      fidelity[v.tissue].in_tets += v.count;
      fidelity[v.tissue].hits += v.hits;
    });
  }
  return fidelity;
}

LabelledLattice LabelLattice::Impl::make_whole(const Stage& stage) {
  LeafMesh mended = mend_lattice(image_, components_, lattice_, votes_, leaves_, mesher_, mend_plan(), stage);
  return {with_cushion_only(std::move(mended.mesh)), fidelity()};
}

LabelledLattice LabelLattice::Impl::build(const Stage& stage) {
  constexpr int kAttempts = 3;
  stage.at(0.15);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (!refine_until_faithful(stage) && attempt > 0) break;
    stage.check_cancelled();
    clean_leaves(votes_, leaves_, mesher_);
    raise_targets(fidelity());
  }
  LabelledLattice result = make_whole(stage);
  stage.at(1);
  return result;
}

// The leaves with most wrong voxels first, until those taken hold as many as each tissue has to mend.
std::vector<TetRef> LabelLattice::Impl::leaves_to_mend(const FidelityGap& gap) const {
  std::vector<std::uint32_t> wrong(leaves_.list().size(), 0);
  parallel_for(leaves_.list().size(), [&](std::size_t i) {
    if (leaves_.list()[i].tet.level >= lattice_.max_level()) return;
    for (const std::uint32_t v : votes_.voxels(leaves_.list()[i].tet)) wrong[i] += gap.wrong[v] != 0;
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < leaves_.list().size(); ++i) {
    if (wrong[i] > 0) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::greater<>(), [&](std::uint32_t i) { return wrong[i]; });
  std::vector<std::uint64_t> open = gap.to_mend;
  std::vector<TetRef> marked;
  for (const std::uint32_t i : order) {
    bool wanted = false;
    for (const std::uint32_t v : votes_.voxels(leaves_.list()[i].tet)) {
      const TissueId t = gap.wrong[v];
      if (t == 0 || open[t] == 0 || leaves_.list()[i].tet.level >= plan_.levels) continue;
      --open[t];
      wanted = true;
    }
    if (wanted) marked.push_back(leaves_.list()[i].tet);
  }
  return marked;
}

// The leaves with a voxel among those missed and another label than that has, larger than it takes to have it.
std::vector<TetRef> LabelLattice::Impl::leaves_that_miss(const std::vector<char>& missed, double fine_mm) const {
  std::vector<char> misses(leaves_.list().size());
  parallel_for(misses.size(), [&](std::size_t i) {
    const TetRef leaf = leaves_.list()[i].tet;
    if (leaf.level >= plan_.levels || std::ldexp(plan_.bcc_size_mm, -leaf.level) <= fine_mm) return;
    const TissueId tissue = votes_.vote(leaf).tissue;
    misses[i] = std::ranges::any_of(votes_.voxels(leaf),
                                    [&](std::uint32_t v) { return missed[v] && image_.voxels[v] != tissue; });
  });
  std::vector<TetRef> leaves;
  for (std::size_t i = 0; i < misses.size(); ++i) {
    if (misses[i]) leaves.push_back(leaves_.list()[i].tet);
  }
  return leaves;
}

std::optional<LabelledLattice> LabelLattice::Impl::refine(const FidelityGap& gap, const Stage& stage) {
  std::vector<char> missed(gap.missed.empty() ? 0 : image_.voxels.size(), 0);
  for (const std::uint32_t v : gap.missed) missed[v] = 1;
  std::vector<TetRef> marked = leaves_to_mend(gap);
  bool refined = false;
  for (;;) {
    if (!missed.empty()) {
      const std::vector<TetRef> more = leaves_that_miss(missed, gap.missed_size_mm);
      marked.insert(marked.end(), more.begin(), more.end());
    }
    if (marked.empty() || !has_room_for(marked)) break;
    stage.check_cancelled();
    votes_.descend(lattice_.refine(marked));
    leaves_.collect(NewLabels::vote);
    refined = true;
    marked.clear();
  }
  if (!refined) return std::nullopt;
  clean_leaves(votes_, leaves_, mesher_);
  return make_whole(stage);
}

TissueMesh LabelLattice::Impl::background() const {
  LeafMesher whole(lattice_, votes_, place_.origin_mm, place_.unit_mm);
  return without_cushion(whole.mesh(leaves_.list(), LeafMesher::Bulk::all).mesh);
}

LabelLattice::LabelLattice(const TissueImage& image, const LatticePlan& plan)
    : impl_(std::make_unique<Impl>(image, plan)) {}
LabelLattice::~LabelLattice() = default;
LabelledLattice LabelLattice::build(const Stage& stage) { return impl_->build(stage); }
std::optional<LabelledLattice> LabelLattice::refine(const FidelityGap& gap, const Stage& stage) {
  return impl_->refine(gap, stage);
}
TissueMesh LabelLattice::background() const { return impl_->background(); }

}  // namespace anatomesh
