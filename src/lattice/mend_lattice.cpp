#include "lattice/mend_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstdio>
#include <utility>

#include "base/parallel.h"
#include "lattice/clean_labels.h"
#include "lattice/mend_pieces.h"
#include "lattice/mend_surfaces.h"

namespace anatomesh {
namespace {

constexpr int kMaxRounds = 16, kPieceRounds = 8, kRepairsPerRound = 3;
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
                VoxelVotes& votes, LabelledLeaves& leaves, const MendPlan& plan)
      : image_(image),
        components_(components),
        lattice_(lattice),
        votes_(votes),
        leaves_(leaves),
        plan_(plan) {}

  LeafMesh run(const Stage& stage) {
    for (int round = 0;; ++round) {
      stage.check_cancelled();
      take_mesh();
      std::vector<TetId> marked;
      if (round < kPieceRounds) marked = mend_pieces_here();
      NewLabels new_labels = NewLabels::vote;
      if (marked.empty() && plan_.manifold) {
        marked = mend_surfaces_here();
        new_labels = NewLabels::inherit;
      }
      record(complex_.mesh, origins_, leaves_);
      if (marked.empty() || round == kMaxRounds) break;
      refine(marked, new_labels);
    }
    return {std::move(complex_.mesh), std::move(points_), std::move(origins_)};
  }

 private:
  void take_mesh();
  TetContents contents() const;
  std::vector<TetId> mend_pieces_here();
  std::vector<TetId> mend_surfaces_here();
  std::vector<TetId> tets_around(const std::vector<VertexId>& singular) const;
  void keep_core(const std::vector<VertexId>& singular);
  std::vector<VertexId> core_vertices() const;
  void refine(const std::vector<TetId>& marked, NewLabels new_labels);

  const TissueImage& image_;
  const ImageComponents& components_;
  RedGreenLattice& lattice_;
  VoxelVotes& votes_;
  LabelledLeaves& leaves_;
  const MendPlan& plan_;

  TetComplex complex_;
  Pieces pieces_;
  std::vector<LatticePoint> points_;
  std::vector<LeafMesh::Origin> origins_;
  TetContents contents_;
  LatticePointMap core_;  // singular vertices before the last refinement, and the middles of the edges between them
};

void LatticeMender::take_mesh() {
  LeafMesh taken = mesh_of_leaves(lattice_, leaves_.list(), plan_.origin_mm, plan_.unit_mm);
  complex_ = make_complex(std::move(taken.mesh));
  points_ = std::move(taken.points);
  origins_ = std::move(taken.origins);
  pieces_ = find_pieces(complex_);
  contents_ = contents();
}

TetContents LatticeMender::contents() const {
  TetContents contents;
  contents.voxels = [this](TetId t) {
    const auto [leaf, part] = origins_[t];
    return votes_.voxels_of_part(leaves_.list()[leaf].tet, part);
  };
  const std::size_t count = origins_.size();
  contents.sizes.resize(count);
  contents.fixed.resize(count);
  contents.may_refine.resize(count);
  contents.decided.resize(count);
  const double voxel_mm3 = image_.spacing_mm.x * image_.spacing_mm.y * image_.spacing_mm.z;
  parallel_for(count, [&](std::size_t t) {
    const LabelledLeaf& leaf = leaves_.list()[origins_[t].leaf];
    const double h = std::ldexp(4 * plan_.unit_mm, -leaf.tet.level);
    contents.sizes[t] = static_cast<float>(h * h * h / 12 / leaf.split().count / voxel_mm3);
    contents.fixed[t] = votes_.hands_label_down(leaf.tet);
    contents.may_refine[t] = leaf.tet.level < plan_.piece_level;
    contents.decided[t] = leaf.decided;
  });
  return contents;
}

std::vector<TetId> LatticeMender::mend_pieces_here() {
  std::vector<TetId> wanted;
  for (int n = 0; n < kRepairsPerRound; ++n) {
    const PieceRepair repair = mend_pieces(complex_, pieces_, image_, components_, contents_);
    if (getenv("TOPO")) fprintf(stderr, "  pieces: wrong %zu changed %zu refine %zu\n", repair.wrong, repair.changed.size(), repair.refine.size());
    for (const TetId t : repair.changed) contents_.decided[t] = 1;
    wanted = repair.refine;
    if (repair.changed.empty()) break;
  }
  return wanted;
}

std::vector<TetId> LatticeMender::mend_surfaces_here() {
  std::vector<TetId> changed;
  if (!core_.points().empty()) mend_neighbourhoods(complex_, pieces_, core_vertices(), contents_.sizes, changed);
  core_ = {};
  if (getenv("TOPO")) fprintf(stderr, "  surfaces: tets %zu singular %zu, by core %zu", origins_.size(), singular_vertices(complex_).size(), changed.size());
  mend_single_tets(complex_, pieces_, voxel_price(complex_, image_, contents_), kMaxPrice, changed);
  const std::vector<VertexId> singular = singular_vertices(complex_);
  if (getenv("TOPO")) fprintf(stderr, " left %zu\n", singular.size());
  std::vector<TetId> marked = tets_around(singular);
  if (marked.empty()) return marked;
  keep_core(singular);
  return marked;
}

// Those that can be refined.
std::vector<TetId> LatticeMender::tets_around(const std::vector<VertexId>& singular) const {
  std::vector<TetId> tets;
  for (const VertexId v : singular) {
    for (const TetId t : complex_.tets_of_vertex[v]) {
      if (leaves_.list()[origins_[t].leaf].tet.level < lattice_.max_level()) tets.push_back(t);
    }
  }
  return tets;
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

void LatticeMender::refine(const std::vector<TetId>& marked, NewLabels new_labels) {
  std::vector<TetRef> leaves;
  for (const TetId t : marked) leaves.push_back(leaves_.list()[origins_[t].leaf].tet);
  votes_.descend(lattice_.refine(leaves));
  leaves_.collect(new_labels);
}

}  // namespace

void clean_leaves(const RedGreenLattice& lattice, const VoxelVotes& votes, LabelledLeaves& leaves,
                  const MendPlan& plan) {
  LeafMesh taken = mesh_of_leaves(lattice, leaves.list(), plan.origin_mm, plan.unit_mm);
  const auto has_weak_vote = [&](TetId t) {
    const LabelledLeaf& leaf = leaves.list()[taken.origins[t].leaf];
    return !leaf.decided && !votes.hands_label_down(leaf.tet) &&
           leaf.votes[taken.origins[t].part].hits < VoxelVotes::kQuorum / 2;
  };
  clean_labels(taken.mesh, has_weak_vote);
  record(taken.mesh, taken.origins, leaves);
}

LeafMesh mend_lattice(const TissueImage& image, const ImageComponents& components, RedGreenLattice& lattice,
                      VoxelVotes& votes, LabelledLeaves& leaves, const MendPlan& plan, const Stage& stage) {
  return LatticeMender(image, components, lattice, votes, leaves, plan).run(stage);
}

}  // namespace anatomesh
