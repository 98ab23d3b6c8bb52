#include "lattice/mend_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "lattice/clean_labels.h"
#include "lattice/mend_pieces.h"
#include "lattice/mend_surfaces.h"

namespace anatomesh {
namespace {

constexpr int kMaxRounds = 12, kPieceRounds = 8;
// Refinement ends beyond four times the tetrahedra before it, and these.
constexpr std::size_t kMinRoom = 200000;
// A larger tangle of singular vertices is left to the relabelling of single tetrahedra, which now are smaller.
constexpr std::size_t kMaxGroup = 2000;
constexpr double kMaxPrice = VoxelVotes::kQuorum / 2;

void record(const TissueMesh& mesh, const std::vector<LeafMesh::Origin>& origins, LabelledLeaves& leaves) {
  for (std::size_t t = 0; t < origins.size(); ++t) {
    const auto [leaf, part] = origins[t];
    if (mesh.tissues[t] != leaves.list()[leaf].votes[part].tissue) leaves.decide(leaf, part, mesh.tissues[t]);
  }
}

class LatticeMender {
 public:
  LatticeMender(const TissueImage& image, const ImageComponents& components, RedGreenLattice& lattice,
                VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher, const MendPlan& plan)
      : image_(image),
        components_(components),
        lattice_(lattice),
        votes_(votes),
        leaves_(leaves),
        mesher_(mesher),
        plan_(plan) {}

  LeafMesh run(const Stage& stage) {
    for (int round = 0;; ++round) {
      stage.check_cancelled();
      take_mesh(round == 0);
      std::vector<TetId> changed, marked;
      mend_around_core(changed);
      if (round == kPieceRounds - 1) std::fill(contents_.may_refine.begin(), contents_.may_refine.end(), char{0});
      if (round < kPieceRounds) mend_pieces_here(changed, marked);
      if (plan_.manifold) mend_surfaces_here(round == 0, changed, marked);
      if (round == 0) max_tets_ = 4 * origins_.size() + kMinRoom;
      const bool last = marked.empty() || round == kMaxRounds || origins_.size() > max_tets_;
      if (last && plan_.manifold) untangle();
      record(complex_.mesh, origins_, leaves_);
      if (last) break;
      refine(marked);
    }
    return {std::move(complex_.mesh), std::move(points_), std::move(origins_), {}};
  }

 private:
  void take_mesh(bool first);
  std::vector<std::array<float, 5>> part_sizes() const;
  TetContents contents() const;
  std::vector<Claim> claims_from(const std::vector<TetId>& from) const;
  void mend_pieces_here(std::vector<TetId>& changed, std::vector<TetId>& marked);
  void mend_around_core(std::vector<TetId>& changed);
  void mend_surfaces_here(bool all, std::vector<TetId>& changed, std::vector<TetId>& marked);
  std::vector<VertexId> fresh_vertices(const std::vector<TetId>& changed) const;
  void mark_around(const std::vector<VertexId>& singular, std::vector<TetId>& marked) const;
  void keep_core(const std::vector<VertexId>& singular);
  std::vector<VertexId> core_vertices() const;
  void untangle();
  void refine(const std::vector<TetId>& marked);

  const TissueImage& image_;
  const ImageComponents& components_;
  RedGreenLattice& lattice_;
  VoxelVotes& votes_;
  LabelledLeaves& leaves_;
  LeafMesher& mesher_;
  const MendPlan& plan_;

  TetComplex complex_;
  Pieces pieces_;
  std::vector<LatticePoint> points_;
  std::vector<LeafMesh::Origin> origins_;
  TetContents contents_;
  std::vector<Claim> claims_;
  std::vector<TetId> fresh_;  // tetrahedra that the last mesh did not have
  std::size_t max_tets_ = 0;
  LatticePointMap core_;  // singular vertices before the last refinement, and the middles of the edges between them
};

void LatticeMender::take_mesh(bool first) {
  LeafMesh taken = mesher_.mesh(leaves_.list());
  complex_ = first ? make_complex(std::move(taken.mesh)) : remake_complex(complex_, std::move(taken.mesh), taken.from);
  points_ = std::move(taken.points);
  origins_ = std::move(taken.origins);
  pieces_ = find_pieces(complex_);
  contents_ = contents();
  claims_ = claims_from(taken.from);
  fresh_.clear();
  for (TetId t = 0; t < taken.from.size(); ++t) {
    if (taken.from[t] == TetComplex::kNone) fresh_.push_back(t);
  }
}

// Volumes of tetrahedra, in voxels: by level of the leaf and number of its parts.
std::vector<std::array<float, 5>> LatticeMender::part_sizes() const {
  const double voxel_mm3 = image_.spacing_mm.x * image_.spacing_mm.y * image_.spacing_mm.z;
  std::vector<std::array<float, 5>> sizes(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; level <= lattice_.max_level(); ++level) {
    const double h = std::ldexp(4 * plan_.unit_mm, -level);
    for (std::size_t parts = 1; parts < 5; ++parts)
      sizes[static_cast<std::size_t>(level)][parts] =
          static_cast<float>(h * h * h / 12 / static_cast<int>(parts) / voxel_mm3);
  }
  return sizes;
}

TetContents LatticeMender::contents() const {
  TetContents contents;
  contents.voxels = [this](TetId t) {
    const auto [leaf, part] = origins_[t];
    return votes_.voxels_of_part(leaves_.list()[leaf].tet, part);
  };
  contents.holder = [this](std::uint32_t voxel) {
    const auto holder = votes_.holder_of(voxel);
    const TetId first = holder ? mesher_.first_tet(holder->leaf) : TetComplex::kNone;
    return first == TetComplex::kNone ? first : first + static_cast<TetId>(holder->part);
  };
  const std::size_t count = origins_.size();
  contents.sizes.resize(count);
  contents.fixed.resize(count);
  contents.may_refine.resize(count);
  contents.decided.resize(count);
  const std::vector<std::array<float, 5>> sizes = part_sizes();
  parallel_for(count, [&](std::size_t t) {
    const LabelledLeaf& leaf = leaves_.list()[origins_[t].leaf];
    contents.sizes[t] = sizes[static_cast<std::size_t>(leaf.tet.level)][static_cast<std::size_t>(leaf.split().count)];
    contents.fixed[t] = votes_.hands_label_down(leaf.tet);
    contents.may_refine[t] = leaf.tet.level < plan_.piece_level;
    contents.decided[t] = leaf.decided;
  });
  return contents;
}

// Those of tetrahedra that have stayed.
std::vector<Claim> LatticeMender::claims_from(const std::vector<TetId>& from) const {
  std::vector<Claim> claims(from.size());
  parallel_for(from.size(), [&](std::size_t t) {
    if (from[t] < claims_.size() && !leaves_.list()[origins_[t].leaf].recounted) claims[t] = claims_[from[t]];
  });
  return claims;
}

// What is marked for the sake of pieces votes anew.
void LatticeMender::mend_pieces_here(std::vector<TetId>& changed, std::vector<TetId>& marked) {
  PieceRepair repair = mend_pieces(complex_, pieces_, image_, components_, contents_, claims_);
  changed.insert(changed.end(), repair.changed.begin(), repair.changed.end());
  marked = std::move(repair.refine);
  for (const TetId t : marked) leaves_.revote(origins_[t].leaf);
}

void LatticeMender::mend_around_core(std::vector<TetId>& changed) {
  if (core_.points().empty()) return;
  mend_neighbourhoods(complex_, pieces_, core_vertices(), Reach::one_tissue, contents_.sizes, kMaxGroup, changed);
  core_ = {};
}

void LatticeMender::mend_surfaces_here(bool all, std::vector<TetId>& changed, std::vector<TetId>& marked) {
  std::vector<VertexId> singular =
      all ? singular_vertices(complex_) : singular_among(complex_, fresh_vertices(changed));
  singular = mend_single_tets(complex_, pieces_, std::move(singular), voxel_price(complex_, image_, contents_),
                              kMaxPrice, changed);
  mark_around(singular, marked);
  keep_core(singular);
}

// Vertices at which something can have changed in this round.
std::vector<VertexId> LatticeMender::fresh_vertices(const std::vector<TetId>& changed) const {
  std::vector<VertexId> vertices;
  const auto add = [&](TetId t) {
    vertices.insert(vertices.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
  };
  for (const TetId t : fresh_) add(t);
  for (const TetId t : changed) add(t);
  return vertices;
}

// Those that can be refined.
void LatticeMender::mark_around(const std::vector<VertexId>& singular, std::vector<TetId>& marked) const {
  for (const VertexId v : singular) {
    for (const TetId t : complex_.tets_of_vertex[v]) {
      if (leaves_.list()[origins_[t].leaf].tet.level < lattice_.max_level()) marked.push_back(t);
    }
  }
}

void LatticeMender::keep_core(const std::vector<VertexId>& singular) {
  for (const VertexId v : singular) {
    core_.insert(points_[v]);
    for (const TetId t : complex_.tets_of_vertex[v]) {
      for (const VertexId w : complex_.mesh.tets[t]) {
        if (w <= v || !std::binary_search(singular.begin(), singular.end(), w)) continue;
        LatticePoint middle;
        for (std::size_t a = 0; a < 3; ++a) middle[a] = (points_[v][a] + points_[w][a]) / 2;
        core_.insert(middle);
      }
    }
  }
}

std::vector<VertexId> LatticeMender::core_vertices() const {
  std::vector<VertexId> vertices;
  for (VertexId v = 0; v < points_.size(); ++v) {
    if (core_.find(points_[v]) != LatticePointMap::kNone) vertices.push_back(v);
  }
  return vertices;
}

// The last resort, where refinement has come to its end: ever larger neighbourhoods of what is singular are given to
// one tissue each.
void LatticeMender::untangle() {
  constexpr int kNearby = 4;  // so often no tissue is taken away from itself
  std::vector<VertexId> tangle;
  std::vector<VertexId> singular = singular_vertices(complex_);
  for (int n = 0; !singular.empty(); ++n, singular = singular_vertices(complex_)) {
    std::vector<TetId> changed;
    tangle.insert(tangle.end(), singular.begin(), singular.end());
    const std::size_t known = tangle.size();
    for (std::size_t i = 0; i < known; ++i) {
      for (const TetId t : complex_.tets_of_vertex[tangle[i]])
        tangle.insert(tangle.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
    }
    std::sort(tangle.begin(), tangle.end());
    tangle.erase(std::unique(tangle.begin(), tangle.end()), tangle.end());
    mend_neighbourhoods(complex_, pieces_, tangle, n < kNearby ? Reach::one_tissue : Reach::any, contents_.sizes,
                        origins_.size(), changed);
    mend_single_tets(complex_, pieces_, singular_vertices(complex_), voxel_price(complex_, image_, contents_),
                     kMaxPrice, changed);
  }
}

void LatticeMender::refine(const std::vector<TetId>& marked) {
  std::vector<TetRef> leaves;
  for (const TetId t : marked) leaves.push_back(leaves_.list()[origins_[t].leaf].tet);
  for (const TetRef leaf : leaves) votes_.keep_voxels(leaf);
  votes_.descend(lattice_.refine(leaves));
  leaves_.collect(NewLabels::inherit);
}

}  // namespace

void clean_leaves(const VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher) {
  LeafMesh taken = mesher.mesh(leaves.list());
  const auto has_weak_vote = [&](TetId t) {
    const LabelledLeaf& leaf = leaves.list()[taken.origins[t].leaf];
    return !leaf.decided && !votes.hands_label_down(leaf.tet) &&
           leaf.votes[taken.origins[t].part].hits < VoxelVotes::kQuorum / 2;
  };
  clean_labels(taken.mesh, has_weak_vote);
  record(taken.mesh, taken.origins, leaves);
}

LeafMesh mend_lattice(const TissueImage& image, const ImageComponents& components, RedGreenLattice& lattice,
                      VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher, const MendPlan& plan,
                      const Stage& stage) {
  return LatticeMender(image, components, lattice, votes, leaves, mesher, plan).run(stage);
}

}  // namespace anatomesh
