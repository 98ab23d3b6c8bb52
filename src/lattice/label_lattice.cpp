#include "lattice/label_lattice.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <unordered_map>

#include "base/parallel.h"
#include "base/vec.h"
#include "lattice/red_green.h"
#include "lattice/voxel_votes.h"

namespace anatomesh {
namespace {

constexpr std::int32_t kMaxCoordinate = 1 << 20;

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
    if (cells * 4 * std::ldexp(1.0, plan.levels + plan.extra_levels) > kMaxCoordinate) {
      throw InvalidInput("a lattice of " + std::to_string(plan.bcc_size_mm) + " mm over " + std::to_string(extent) +
                         " mm of image is too large; take a larger bcc_size");
    }
    place.cells[a] = static_cast<std::int32_t>(cells);
    const double low = (static_cast<double>(image.first[a] + TissueImage::kBorder) - 0.5) * image.spacing_mm[a];
    place.origin_mm[a] = low + 0.5 * extent - 0.5 * cells * plan.bcc_size_mm;
  }
  return place;
}

std::vector<TetRef> leaves_of(const RedGreenLattice& lattice) {
  std::vector<TetRef> leaves;
  for (int level = 0; level <= lattice.max_level(); ++level) {
    for (const TetRef t : lattice.tets_of_level(level)) {
      if (lattice.is_leaf(t)) leaves.push_back(t);
    }
  }
  return leaves;
}

// Fidelity, and which tissues have a tetrahedron at all.
struct Score {
  std::vector<LatticeFidelity> fidelity;
  std::vector<std::uint64_t> tets;

  explicit Score(std::size_t tissues) : fidelity(tissues), tets(tissues) {}
  void add(const Vote& v) {
    fidelity[v.tissue].in_tets += v.count;
    fidelity[v.tissue].hits += v.hits;
    ++tets[v.tissue];
  }
  void add(const Score& other) {
    for (std::size_t t = 0; t < tets.size(); ++t) {
      fidelity[t].in_tets += other.fidelity[t].in_tets;
      fidelity[t].hits += other.fidelity[t].hits;
      tets[t] += other.tets[t];
    }
  }
};

class LabelLattice {
 public:
  LabelLattice(const TissueImage& image, const LatticePlan& plan)
      : image_(image),
        plan_(plan),
        place_(place_lattice(image, plan)),
        lattice_(place_.cells, plan.levels + plan.extra_levels),
        votes_(image, lattice_, place_.origin_mm, place_.unit_mm) {}

  void refine_until_faithful(const Stage& stage);
  LabelledLattice extract() const;

 private:
  Score score(const std::vector<TetRef>& leaves) const;
  std::vector<TetRef> leaves_to_refine(const std::vector<TetRef>& leaves, const Score& score) const;
  bool wants_refinement(TetRef leaf, const std::vector<int>& level_limit) const;
  template <class Visit>
  void visit_parts(TetRef leaf, const Visit& visit) const;

  const TissueImage& image_;
  const LatticePlan& plan_;
  Placement place_;
  RedGreenLattice lattice_;
  VoxelVotes votes_;
};

// Calls visit(vote, nodes) for a leaf, or for each of its green parts.
template <class Visit>
void LabelLattice::visit_parts(TetRef leaf, const Visit& visit) const {
  const unsigned mask = lattice_.split_edges(leaf);
  const GreenSplit& split = green_split(mask);
  if (mask == 0) return visit(votes_.vote(leaf), split.tets[0]);
  const auto votes = votes_.green_votes(leaf);
  for (std::size_t c = 0; c < static_cast<std::size_t>(split.count); ++c) visit(votes[c], split.tets[c]);
}

Score LabelLattice::score(const std::vector<TetRef>& leaves) const {
  Score total(image_.labels.size());
  std::mutex mutex;
  parallel_blocks(leaves.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    Score part(image_.labels.size());
    for (std::size_t i = begin; i < end; ++i) visit_parts(leaves[i], [&](const Vote& v, const auto&) { part.add(v); });
    const std::scoped_lock lock(mutex);
    total.add(part);
  });
  // What refined pure tetrahedra handed down without counting.
  for (int level = 0; level < lattice_.max_level(); ++level) {
    for (const TetRef t : lattice_.tets_of_level(level)) {
      if (!lattice_.is_refined(t) || !votes_.hands_label_down(t)) continue;
      total.fidelity[votes_.vote(t).tissue].in_tets += votes_.vote(t).count;
      total.fidelity[votes_.vote(t).tissue].hits += votes_.vote(t).hits;
    }
  }
  for (std::size_t t = 0; t < image_.counts.size(); ++t) total.fidelity[t].voxels = image_.counts[t];
  return total;
}

// A leaf is refined when the boundary of a tissue that falls short passes between its voxels.
bool LabelLattice::wants_refinement(TetRef leaf, const std::vector<int>& level_limit) const {
  const auto voxels = votes_.voxels(leaf);
  if (voxels.size() < 2)
    return !voxels.empty() && level_limit[image_.voxels[voxels[0]]] > plan_.levels &&
           leaf.level < level_limit[image_.voxels[voxels[0]]];
  const TissueId first = image_.voxels[voxels[0]];
  bool mixed = false;
  int limit = level_limit[first];
  for (const std::uint32_t v : voxels) {
    mixed = mixed || image_.voxels[v] != first;
    limit = std::max(limit, level_limit[image_.voxels[v]]);
  }
  return (mixed || limit > plan_.levels) && leaf.level < limit;
}

std::vector<TetRef> LabelLattice::leaves_to_refine(const std::vector<TetRef>& leaves, const Score& score) const {
  std::vector<int> level_limit(image_.labels.size(), 0);  // refine below this level only
  for (std::size_t t = 1; t < level_limit.size(); ++t) {
    const LatticeFidelity& f = score.fidelity[t];
    if (f.f1() < plan_.fidelity[t] || f.f2() < plan_.fidelity[t]) level_limit[t] = plan_.levels;
    if (score.tets[t] == 0) level_limit[t] = lattice_.max_level();
  }
  std::vector<char> wanted(leaves.size());
  parallel_for(leaves.size(), [&](std::size_t i) { wanted[i] = wants_refinement(leaves[i], level_limit); });
  std::vector<TetRef> marked;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (wanted[i]) marked.push_back(leaves[i]);
  }
  return marked;
}

void LabelLattice::refine_until_faithful(const Stage& stage) {
  for (int round = 0;; ++round) {
    const std::vector<TetRef> leaves = leaves_of(lattice_);
    const std::vector<TetRef> marked = leaves_to_refine(leaves, score(leaves));
    if (marked.empty()) return;
    votes_.descend(lattice_.refine(marked));
    stage.at(std::min(0.9, 0.2 * (round + 1)));
  }
}

std::uint64_t pack(const LatticePoint& p) {
  return static_cast<std::uint64_t>(p[0] + kMaxCoordinate) | static_cast<std::uint64_t>(p[1] + kMaxCoordinate) << 21 |
         static_cast<std::uint64_t>(p[2] + kMaxCoordinate) << 42;
}

// Numbers lattice points in the order in which they are first asked for.
class VertexNumbers {
 public:
  explicit VertexNumbers(std::size_t expected) { ids_.reserve(expected); }
  VertexId operator()(const LatticePoint& p) {
    const auto [at, fresh] = ids_.try_emplace(pack(p), static_cast<VertexId>(points.size()));
    if (fresh) points.push_back(p);
    return at->second;
  }
  bool knows(const LatticePoint& p) const { return ids_.contains(pack(p)); }
  std::vector<LatticePoint> points;

 private:
  struct Hash {
    std::size_t operator()(std::uint64_t key) const {
      return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ULL >> 16);
    }
  };
  std::unordered_map<std::uint64_t, VertexId, Hash> ids_;
};

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

LabelledLattice LabelLattice::extract() const {
  const std::vector<TetRef> leaves = leaves_of(lattice_);
  LabelledLattice result;
  result.fidelity = score(leaves).fidelity;
  TissueMesh& mesh = result.mesh;
  VertexNumbers number(leaves.size() / 4);
  const auto add_tet = [&](const std::array<LatticePoint, 10>& nodes, const std::array<std::uint8_t, 4>& corner,
                           bool positive, TissueId tissue) {
    std::array<VertexId, 4> tet;
    for (std::size_t n = 0; n < 4; ++n) tet[n] = number(nodes[corner[n]]);
    if (!positive) std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
    mesh.tissues.push_back(tissue);
  };
  for (const TetRef leaf : leaves) {
    const auto nodes = leaf_nodes(lattice_, leaf);
    const bool positive = is_positive(lattice_.barycentre(leaf));
    visit_parts(leaf, [&](const Vote& v, const auto& corner) {
      if (v.tissue != 0) add_tet(nodes, corner, positive, v.tissue);
    });
  }
  const VertexNumbers on_tissue = number;
  for (const TetRef leaf : leaves) {
    const auto nodes = leaf_nodes(lattice_, leaf);
    const bool positive = is_positive(lattice_.barycentre(leaf));
    visit_parts(leaf, [&](const Vote& v, const auto& corner) {
      const bool touches = std::any_of(corner.begin(), corner.end(), [&](auto n) { return on_tissue.knows(nodes[n]); });
      if (v.tissue == 0 && touches) add_tet(nodes, corner, positive, 0);
    });
  }
  const double fine_unit = place_.unit_mm / static_cast<double>(1 << lattice_.max_level());
  mesh.points_mm.reserve(number.points.size());
  for (const LatticePoint& p : number.points) {
    mesh.points_mm.push_back(place_.origin_mm + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]});
  }
  return result;
}

}  // namespace

LabelledLattice build_labelled_lattice(const TissueImage& image, const LatticePlan& plan, const Stage& stage) {
  LabelLattice lattice(image, plan);
  stage.at(0.15);
  lattice.refine_until_faithful(stage);
  stage.at(0.9);
  return lattice.extract();
}

}  // namespace anatomesh
