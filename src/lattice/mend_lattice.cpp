#include "lattice/mend_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "lattice/clean_labels.h"
#include "lattice/mend_pieces.h"
#include "lattice/mend_surfaces.h"
#include "lattice/update_pieces.h"

namespace anatomesh {
namespace {

constexpr int kMaxRounds = 12, kPieceRounds = 8;
// Refinement ends beyond four times the tetrahedra before it, and these.
constexpr std::size_t kMinRoom = 200000;
// A larger tangle of singular vertices is left to the relabelling of single tetrahedra, which now are smaller.
constexpr std::size_t kMaxGroup = 2000;
constexpr double kMaxPrice = VoxelVotes::kQuorum / 2;

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
    take_mesh();
    for (int round = 0;; ++round) {
      stage.check_cancelled();
      changed_.clear();
      mend_around_core();
      if (round == kPieceRounds - 1) std::fill(contents_.may_refine.begin(), contents_.may_refine.end(), char{0});
      std::vector<TetId> marked;
      if (round < kPieceRounds) marked = mend_pieces_here();
      if (plan_.manifold) mend_surfaces_here(round == 0, marked);
      const bool last = marked.empty() || round == kMaxRounds || live_tets_ > max_tets_;
      if (last && plan_.manifold) untangle();
      record_labels();
      if (last) break;
      refine(marked);
    }
    if (first_fresh_ == 0) return {std::move(complex_.mesh), std::move(origins_)};  // nothing was refined
    leaves_.collect(NewLabels::inherit);
    return mesher_.mesh(leaves_.list());
  }

 private:
  void take_mesh();
  std::vector<std::array<float, 5>> part_sizes() const;
  TetContents empty_contents() const;
  void extend_contents();
  void describe(TetId t);
  std::vector<TetId> mend_pieces_here();
  void mend_around_core();
  void mend_surfaces_here(bool all, std::vector<TetId>& marked);
  std::vector<VertexId> fresh_vertices() const;
  void mark_around(const std::vector<VertexId>& singular, std::vector<TetId>& marked) const;
  void keep_core(const std::vector<VertexId>& singular);
  std::vector<VertexId> core_vertices() const;
  void untangle();
  void record_labels();
  void refine(const std::vector<TetId>& marked);
  void follow_leaves(std::vector<std::uint32_t> touched);
  LatticePoint point(VertexId v) const { return mesher_.vertices().points()[v]; }

  const TissueImage& image_;
  const ImageComponents& components_;
  RedGreenLattice& lattice_;
  VoxelVotes& votes_;
  LabelledLeaves& leaves_;
  LeafMesher& mesher_;
  const MendPlan& plan_;

  TetComplex complex_;
  Pieces pieces_;
  std::vector<LeafMesh::Origin> origins_;
  TetContents contents_;
  std::vector<std::array<float, 5>> part_sizes_;
  std::vector<Claim> claims_;
  TetId first_fresh_ = 0;               // tetrahedra from here on are new since the last round
  std::vector<TetId> changed_;          // relabelled in this round
  std::vector<std::uint32_t> decided_;  // leaves that they are of
  std::vector<VertexId> singular_;      // that were left
  std::size_t live_tets_ = 0, max_tets_ = 0;
  LatticePointMap core_;  // singular vertices before the last refinement, and the middles of the edges between them
};

void LatticeMender::take_mesh() {
  LeafMesh taken = mesher_.mesh(leaves_.list());
  complex_ = make_complex(std::move(taken.mesh));
  origins_ = std::move(taken.origins);
  live_tets_ = origins_.size();
  max_tets_ = 4 * live_tets_ + kMinRoom;
  pieces_ = find_pieces(complex_);
  part_sizes_ = part_sizes();
  contents_ = empty_contents();
  extend_contents();
  parallel_for(origins_.size(), [&](std::size_t t) { describe(static_cast<TetId>(t)); });
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

TetContents LatticeMender::empty_contents() const {
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
  return contents;
}

void LatticeMender::extend_contents() {
  const std::size_t count = origins_.size();
  contents_.sizes.resize(count);
  contents_.fixed.resize(count);
  contents_.may_refine.resize(count);
  contents_.decided.resize(count);
  claims_.resize(count);
}

void LatticeMender::describe(TetId t) {
  const LabelledLeaf& leaf = leaves_.list()[origins_[t].leaf];
  contents_.sizes[t] =
      part_sizes_[static_cast<std::size_t>(leaf.tet.level)][static_cast<std::size_t>(leaf.split().count)];
  contents_.fixed[t] = votes_.hands_label_down(leaf.tet);
  contents_.may_refine[t] = leaf.tet.level < plan_.piece_level;
  contents_.decided[t] = leaf.decided;
}

// What is marked for the sake of pieces votes anew.
std::vector<TetId> LatticeMender::mend_pieces_here() {
  PieceRepair repair = mend_pieces(complex_, pieces_, image_, components_, contents_, claims_);
  changed_.insert(changed_.end(), repair.changed.begin(), repair.changed.end());
  for (const TetId t : repair.refine) leaves_.revote(origins_[t].leaf);
  return std::move(repair.refine);
}

void LatticeMender::mend_around_core() {
  if (core_.points().empty()) return;
  mend_neighbourhoods(complex_, pieces_, core_vertices(), Reach::one_tissue, contents_.sizes, kMaxGroup, changed_);
  core_ = {};
}

void LatticeMender::mend_surfaces_here(bool all, std::vector<TetId>& marked) {
  singular_ = all ? singular_vertices(complex_) : singular_among(complex_, fresh_vertices());
  singular_ = mend_single_tets(complex_, pieces_, std::move(singular_), voxel_price(complex_, image_, contents_),
                               kMaxPrice, changed_);
  mark_around(singular_, marked);
  keep_core(singular_);
}

// Vertices at which something can have changed in this round.
std::vector<VertexId> LatticeMender::fresh_vertices() const {
  std::vector<VertexId> vertices;
  const auto add = [&](TetId t) {
    vertices.insert(vertices.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
  };
  for (TetId t = first_fresh_; t < origins_.size(); ++t) add(t);
  for (const TetId t : changed_) add(t);
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
    core_.insert(point(v));
    for (const TetId t : complex_.tets_of_vertex[v]) {
      for (const VertexId w : complex_.mesh.tets[t]) {
        if (w <= v || !std::binary_search(singular.begin(), singular.end(), w)) continue;
        LatticePoint middle;
        for (std::size_t a = 0; a < 3; ++a) middle[a] = (point(v)[a] + point(w)[a]) / 2;
        core_.insert(middle);
      }
    }
  }
}

std::vector<VertexId> LatticeMender::core_vertices() const {
  std::vector<VertexId> vertices;
  for (const LatticePoint& p : core_.points()) {
    if (const VertexId v = mesher_.vertices().find(p); v != LatticePointMap::kNone) vertices.push_back(v);
  }
  std::ranges::sort(vertices);
  return vertices;
}

// The last resort, where refinement has come to its end: ever larger neighbourhoods of what is singular are given to
// one tissue each.
void LatticeMender::untangle() {
  constexpr int kNearby = 4;  // so often no tissue is taken away from itself
  std::vector<VertexId> tangle;
  for (int n = 0; !singular_.empty(); ++n, singular_ = singular_vertices(complex_)) {
    tangle.insert(tangle.end(), singular_.begin(), singular_.end());
    const std::size_t known = tangle.size();
    for (std::size_t i = 0; i < known; ++i) {
      for (const TetId t : complex_.tets_of_vertex[tangle[i]])
        tangle.insert(tangle.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
    }
    sort_and_unify(tangle);
    mend_neighbourhoods(complex_, pieces_, tangle, n < kNearby ? Reach::one_tissue : Reach::any, contents_.sizes,
                        origins_.size(), changed_);
    mend_single_tets(complex_, pieces_, singular_vertices(complex_), voxel_price(complex_, image_, contents_),
                     kMaxPrice, changed_);
  }
}

void LatticeMender::record_labels() {
  decided_.clear();
  for (const TetId t : changed_) {
    const auto [leaf, part] = origins_[t];
    if (leaves_.decide(leaf, part, complex_.tissue(t))) decided_.push_back(leaf);
  }
}

void LatticeMender::refine(const std::vector<TetId>& marked) {
  std::vector<TetRef> leaves, renewed;
  for (const TetId t : marked) leaves.push_back(leaves_.list()[origins_[t].leaf].tet);
  for (const TetRef leaf : leaves) {
    const std::vector<TetRef> known = votes_.keep_voxels(leaf);
    renewed.insert(renewed.end(), known.begin(), known.end());
  }
  const std::vector<TetRef> refined = lattice_.refine(leaves);
  votes_.descend(refined);
  std::vector<std::uint32_t> touched = leaves_.replace(refined, renewed);
  touched.insert(touched.end(), decided_.begin(), decided_.end());
  follow_leaves(std::move(touched));
}

// Tetrahedra keep their numbers.
void LatticeMender::follow_leaves(std::vector<std::uint32_t> touched) {
  sort_and_unify(touched);
  first_fresh_ = static_cast<TetId>(origins_.size());
  const std::vector<TetId> dropped = mesher_.update(leaves_.list(), touched, complex_.mesh, origins_);
  live_tets_ += origins_.size() - first_fresh_ - dropped.size();
  replace_tets(complex_, dropped, first_fresh_);
  std::vector<TetId> replaced = dropped;
  for (TetId t = first_fresh_; t < origins_.size(); ++t) replaced.push_back(t);
  update_pieces(complex_, pieces_, replaced);
  extend_contents();
  for (const TetId t : dropped) claims_[t] = {};
  for (const std::uint32_t i : touched) {
    const LabelledLeaf& leaf = leaves_.list()[i];
    const TetId first = leaf.gone ? TetComplex::kNone : mesher_.first_tet(leaf.tet);
    if (first == TetComplex::kNone) continue;
    for (TetId t = first; t < first + static_cast<TetId>(leaf.split().count); ++t) {
      describe(t);
      if (leaf.recounted) claims_[t] = {};
    }
  }
  for (TetId t = first_fresh_; t < origins_.size(); ++t) describe(t);
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
  for (std::size_t t = 0; t < taken.origins.size(); ++t) {
    const auto [leaf, part] = taken.origins[t];
    leaves.decide(leaf, part, taken.mesh.tissues[t]);
  }
}

LeafMesh mend_lattice(const TissueImage& image, const ImageComponents& components, RedGreenLattice& lattice,
                      VoxelVotes& votes, LabelledLeaves& leaves, LeafMesher& mesher, const MendPlan& plan,
                      const Stage& stage) {
  return LatticeMender(image, components, lattice, votes, leaves, mesher, plan).run(stage);
}

}  // namespace anatomesh
