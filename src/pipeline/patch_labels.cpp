#include "pipeline/patch_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"
#include "boundary/label_field.h"
#include "deform/improve.h"
#include "deform/improve_shapes.h"
#include "deform/refine_edges.h"
#include "lattice/clean_labels.h"
#include "lattice/mend_pieces.h"
#include "lattice/mend_surfaces.h"
#include "mesh/mesh_editor.h"
#include "mesh/vertices_by_point.h"
#include "mesh/voxel_owners.h"

namespace anatomesh {
namespace {

constexpr int kMaxRounds = 8;
constexpr double kMaxPrice = 5;               // voxels that a relabelled tetrahedron may cost
constexpr int kFewRings = 2, kManyRings = 3;  // of tetrahedra around a singular vertex that are given to one tissue
constexpr float kSmallest = 0.02f;            // voxels; smaller tetrahedra are not split
constexpr int kFewPoints = 3, kManyPoints = 8;

std::array<Vec3, 4> corners_of(const TissueMesh& mesh, TetId t) {
  std::array<Vec3, 4> p;
  for (std::size_t n = 0; n < 4; ++n) p[n] = mesh.points_mm[mesh.tets[t][n]];
  return p;
}

double volume_of(const TissueMesh& mesh, TetId t) {
  const auto [a, b, c, d] = corners_of(mesh, t);
  return six_volumes(a, b, c, d) / 6;
}

bool is_within(const TissueMesh& mesh, TetId t, const ShapeBounds& bounds) {
  const auto [a, b, c, d] = corners_of(mesh, t);
  return within(bounds, a, b, c, d);
}

// Calls visit(p) for points spread evenly over a tetrahedron, n (n + 1) (n + 2) / 6 of them.
template <class Visit>
void for_each_point(const std::array<Vec3, 4>& corners, int n, const Visit& visit) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      for (int k = 0; i + j + k < n; ++k) {
        const std::array<int, 4> share = {i, j, k, n - 1 - i - j - k};
        Vec3 p;
        for (std::size_t c = 0; c < 4; ++c) p += (share[c] + 0.25) / n * corners[c];
        visit(p);
      }
    }
  }
}

// The voter for one tetrahedron; its own tissue where no changed voxel is near.
TissueId voted(const TissueMesh& mesh, TetId t, const LabelField& field, const std::vector<char>& is_changed,
               bool& asked) {
  const TissueImage& image = field.image();
  const auto corners = corners_of(mesh, t);
  const double voxel_mm = std::cbrt(image.spacing_mm.x * image.spacing_mm.y * image.spacing_mm.z);
  double longest = 0;
  for (const Vec3& p : corners) longest = std::max(longest, norm(p - corners[0]));
  const int n = std::clamp(static_cast<int>(std::ceil(longest / voxel_mm)), kFewPoints, kManyPoints);
  asked = false;
  for_each_point(corners, n, [&](Vec3 p) {
    const auto [i, j, k] = image.index_at(p);
    asked = asked || (image.contains(i, j, k) && is_changed[image.offset(i, j, k)]);
  });
  if (!asked) return mesh.tissues[t];
  std::map<TissueId, int> votes;
  for_each_point(corners, n, [&](Vec3 p) { ++votes[field.label_at(p)]; });
  // Of equal ones its own, then the lowest.
  TissueId best = mesh.tissues[t];
  for (const auto& [tissue, count] : votes) {
    if (count > votes[best]) best = tissue;
  }
  return best;
}

class PatchMender {
 public:
  PatchMender(TissueMesh& mesh, const LabelMending& mending)
      : mesh_(mesh), mending_(mending), price_in_voxels_(voxel_price(complex_, mending.image, contents_)) {
    for (VertexId v = 0; v < mending.border_mm.size(); ++v) border_.add(mending.border_mm[v], v);
    for (const auto& contact : mending.rest.contacts) contacts_[contact.vertex].push_back(contact);
  }

  std::optional<MendFailure> run(const Stage& stage) {
    for (int round = 0;; ++round) {
      stage.check_cancelled();
      take_mesh(round < kMaxRounds);
      std::vector<TetId> changed;
      std::vector<Claim> claims(mesh_.tets.size());
      PieceRepair repair = mend_pieces(complex_, pieces_, mending_.image, mending_.components, contents_, claims);
      singular_ = mend_single_tets(
          complex_, pieces_, singular_among(complex_, inner_vertices()),
          [this](TetId t, TissueId tissue) { return price(t, tissue); }, kMaxPrice, changed);
      std::vector<TetId> marked = std::move(repair.refine);
      std::erase_if(marked, [&](TetId t) { return !contents_.may_refine[t]; });
      if (!singular_.empty() && marked.empty()) untangle(kFewRings, kMaxPrice);
      mesh_.tissues = complex_.mesh.tissues;
      if (singular_.empty() && counts_agree()) return std::nullopt;
      if (round >= kMaxRounds || !refine(marked, stage)) break;
    }
    if (!singular_.empty()) untangle(kManyRings, kTooDear);
    mesh_.tissues = complex_.mesh.tissues;
    if (singular_.empty() && counts_agree()) return std::nullopt;
    return failure();
  }

 private:
  void take_mesh(bool may_refine);
  void join_beyond();
  void find_voxels();
  TetId holder_of(std::uint32_t voxel) const;
  std::vector<VertexId> inner_vertices() const;
  std::vector<char> miscounted() const;
  bool counts_agree() const;
  MendFailure failure() const;
  bool refine(std::vector<TetId>& marked, const Stage& stage);
  std::vector<TetId> tets_around(VertexId v, int rings) const;
  bool unite(const std::vector<TetId>& group, double max_price);
  void untangle(int max_rings, double max_price);
  double price(TetId t, TissueId tissue) const;

  TissueMesh& mesh_;
  const LabelMending& mending_;
  VerticesByPoint border_;
  std::map<VertexId, std::vector<RestPieces::Contact>> contacts_;
  std::set<std::pair<TissueId, std::uint32_t>> lone_;  // pieces of the rest that touch the patch at vertices only
  TetComplex complex_;
  Pieces pieces_;
  std::vector<char> is_border_;
  TetContents contents_;
  RelabelPrice price_in_voxels_;
  std::vector<std::uint32_t> voxel_begin_, voxels_;  // by tetrahedron
  std::vector<TetId> owner_;                         // by voxel of the part
  std::vector<char> is_bad_;                         // outside the bounds: background that cannot become a tissue
  std::vector<VertexId> singular_;
};

void PatchMender::take_mesh(bool may_refine) {
  complex_ = make_complex(mesh_);
  is_border_ = border_vertices(complex_);
  join_beyond();
  pieces_ = find_pieces(complex_);
  find_voxels();
  const std::size_t count = mesh_.tets.size();
  const Vec3 s = mending_.image.spacing_mm;
  contents_.sizes.resize(count);
  contents_.fixed.resize(count);
  contents_.may_refine.resize(count);
  contents_.decided.assign(count, 0);
  contents_.held.resize(count);
  is_bad_.resize(count);
  parallel_for(count, [&](std::size_t t) {
    const auto id = static_cast<TetId>(t);
    contents_.sizes[t] = static_cast<float>(volume_of(mesh_, id) / (s.x * s.y * s.z));
    const bool touches_border = std::ranges::any_of(mesh_.tets[t], [&](VertexId v) { return is_border_[v] != 0; });
    contents_.fixed[t] = contents_.held[t] = touches_border;
    is_bad_[t] = !is_within(mesh_, id, mending_.bounds);
    contents_.may_refine[t] = may_refine && !contents_.fixed[t] && contents_.sizes[t] > kSmallest;
  });
  contents_.voxels = [this](TetId t) {
    return std::span(voxels_).subspan(voxel_begin_[t], voxel_begin_[t + 1] - voxel_begin_[t]);
  };
  contents_.holder = [this](std::uint32_t voxel) { return holder_of(voxel); };
}

TetId PatchMender::holder_of(std::uint32_t voxel) const {
  const TissueImage &part = mending_.part, &image = mending_.image;
  const auto nx = static_cast<std::uint32_t>(image.size[0]), ny = static_cast<std::uint32_t>(image.size[1]);
  const std::array<std::uint32_t, 3> index = {voxel % nx, voxel / nx % ny, voxel / nx / ny};
  std::array<int, 3> at;
  for (std::size_t a = 0; a < 3; ++a)
    at[a] = static_cast<int>(static_cast<std::int64_t>(index[a]) + image.first[a] - part.first[a]);
  const TetId t = part.contains(at[0], at[1], at[2]) ? owner_[part.offset(at[0], at[1], at[2])] : kNoTet;
  return t == kNoTet ? TetComplex::kNone : t;
}

// Tetrahedra that touch the same piece of the rest.
void PatchMender::join_beyond() {
  complex_.joined_beyond.clear();
  lone_.clear();
  for (const auto& contact : mending_.rest.contacts) lone_.emplace(contact.tissue, contact.piece);
  std::map<std::pair<TissueId, std::uint32_t>, TetId> first;
  for (VertexId v = 0; v < mesh_.points_mm.size(); ++v) {
    if (!is_border_[v]) continue;
    const auto known = border_.at(mesh_.points_mm[v]);
    if (!known) continue;
    const auto contacts = contacts_.find(*known);
    if (contacts == contacts_.end()) continue;
    for (const auto& contact : contacts->second) {
      for (const TetId t : complex_.tets_of_vertex[v]) {
        if (mesh_.tissues[t] != contact.tissue) continue;
        lone_.erase({contact.tissue, contact.piece});
        const auto [at, is_new] = first.try_emplace(std::pair(contact.tissue, contact.piece), t);
        if (!is_new && at->second != t) complex_.joined_beyond.push_back({at->second, t});
      }
    }
  }
}

void PatchMender::find_voxels() {
  const TissueImage &part = mending_.part, &image = mending_.image;
  GridSize size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = static_cast<std::size_t>(part.size[a]);
  std::vector<Vec3> points(mesh_.points_mm.size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a)
      points[v][a] = mesh_.points_mm[v][a] / part.spacing_mm[a] - static_cast<double>(part.first[a]);
  }
  owner_.assign(part.voxels.size(), kNoTet);
  for_each_owned_slices(points, mesh_.tets, size, {}, [&](const OwnedSlices& slices) {
    std::copy(slices.owner.begin(), slices.owner.end(),
              owner_.begin() + static_cast<std::ptrdiff_t>(slices.first * size[0] * size[1]));
  });
  voxel_begin_.assign(mesh_.tets.size() + 1, 0);
  for (const TetId t : owner_) {
    if (t != kNoTet) ++voxel_begin_[t + 1];
  }
  std::partial_sum(voxel_begin_.begin(), voxel_begin_.end(), voxel_begin_.begin());
  std::vector<std::uint32_t> next(voxel_begin_.begin(), voxel_begin_.end() - 1);
  voxels_.assign(voxel_begin_.back(), 0);
  std::size_t v = 0;
  std::array<int, 3> shift;
  for (std::size_t a = 0; a < 3; ++a) shift[a] = static_cast<int>(part.first[a] - image.first[a]);
  for (int k = 0; k < part.size[2]; ++k) {
    for (int j = 0; j < part.size[1]; ++j) {
      for (int i = 0; i < part.size[0]; ++i, ++v) {
        if (owner_[v] == kNoTet) continue;
        const std::array<int, 3> at = {i + shift[0], j + shift[1], k + shift[2]};
        // Beyond the crop there is background only: any voxel of it stands for that.
        const std::size_t offset = image.contains(at[0], at[1], at[2]) ? image.offset(at[0], at[1], at[2]) : 0;
        voxels_[next[owner_[v]]++] = static_cast<std::uint32_t>(offset);
      }
    }
  }
}

std::vector<VertexId> PatchMender::inner_vertices() const {
  std::vector<VertexId> inner;
  for (VertexId v = 0; v < is_border_.size(); ++v) {
    if (!is_border_[v]) inner.push_back(v);
  }
  return inner;
}

// By tissue: whether it has not as many pieces as components, over all of the mesh. Of the tissues that are or were in
// the patch.
std::vector<char> PatchMender::miscounted() const {
  const auto components = mending_.components.count_by_tissue(mending_.image.labels.size());
  std::vector<char> result(components.size(), 0);
  std::vector<std::uint32_t> pieces(components.size(), 0);
  for (const auto& piece : pieces_.list) pieces[piece.tissue] += piece.tets > 0;
  for (const auto& [tissue, piece] : lone_) ++pieces[tissue];
  for (std::size_t t = 1; t < components.size(); ++t) {
    if (!mending_.rest.counted[t] && pieces[t] == 0) continue;
    const int found = static_cast<int>(pieces[t] + mending_.rest.closed[t]), wanted = static_cast<int>(components[t]);
    const bool is_there = (found > 0) == (wanted > 0);
    result[t] = !mending_.rest.counted[t] || !is_there || std::abs(found - wanted) > mending_.pieces_off[t];
  }
  return result;
}

bool PatchMender::counts_agree() const {
  return std::ranges::none_of(miscounted(), [](char is_off) { return is_off != 0; });
}

MendFailure PatchMender::failure() const {
  MendFailure failure = {{}, miscounted()};
  for (const VertexId v : singular_) failure.singular_mm.push_back(complex_.mesh.points_mm[v]);
  return failure;
}

bool PatchMender::refine(std::vector<TetId>& marked, const Stage& stage) {
  sort_and_unify(marked);
  // The background is improved like a tissue.
  const auto air = static_cast<TissueId>(mending_.image.labels.size());
  TissueMesh finer = mesh_;
  std::ranges::replace(finer.tissues, TissueId{0}, air);
  MeshEditor editor(finer);
  std::size_t splits = split_tets(editor, mending_.bounds, marked);
  for (const VertexId v : singular_) splits += split_around(editor, mending_.bounds, v);
  if (splits == 0) return false;
  improve_shapes(editor, mending_.bounds, kEnoughSlack, stage);
  mesh_ = editor.result();
  std::ranges::replace(mesh_.tissues, air, TissueId{0});
  return true;
}

// Tetrahedra around a vertex, so many rings of them, ascending.
std::vector<TetId> PatchMender::tets_around(VertexId v, int rings) const {
  std::vector<TetId> tets(complex_.tets_of_vertex[v].begin(), complex_.tets_of_vertex[v].end());
  for (int ring = 1; ring < rings; ++ring) {
    std::vector<TetId> more;
    for (const TetId t : tets) {
      for (const VertexId w : complex_.mesh.tets[t])
        more.insert(more.end(), complex_.tets_of_vertex[w].begin(), complex_.tets_of_vertex[w].end());
    }
    tets = std::move(more);
    sort_and_unify(tets);
  }
  return tets;
}

// Gives all tetrahedra of a group to the tissue that leaves fewest defects, fewer than there are, and of equal ones to
// the cheapest. Where the numbers of pieces are right they stay so. Whether there was one.
bool PatchMender::unite(const std::vector<TetId>& group, double max_price) {
  std::vector<VertexId> vertices;
  std::vector<TissueId> own;
  for (const TetId t : group) {
    if (contents_.fixed[t]) return false;
    own.push_back(complex_.tissue(t));
    vertices.insert(vertices.end(), complex_.mesh.tets[t].begin(), complex_.mesh.tets[t].end());
  }
  sort_and_unify(vertices);
  std::vector<TissueId> tissues = own;
  sort_and_unify(tissues);
  const auto defects = [&] {
    unsigned sum = 0;
    for (const VertexId v : vertices) sum += star_defect(complex_, v);
    return sum;
  };
  const bool agreed = counts_agree();
  std::pair<unsigned, double> least = {defects(), 0};
  std::optional<TissueId> best;
  for (const TissueId tissue : tissues) {
    double cost = 0;
    for (const TetId t : group) cost += complex_.tissue(t) == tissue ? 0 : price(t, tissue);
    if (cost > max_price) continue;
    for (const TetId t : group) complex_.mesh.tissues[t] = tissue;
    const std::pair<unsigned, double> left = {defects(), cost};
    if (left < least) {
      pieces_ = find_pieces(complex_);
      if (!agreed || counts_agree()) {
        least = left;
        best = tissue;
      }
    }
    for (std::size_t n = 0; n < group.size(); ++n) complex_.mesh.tissues[group[n]] = own[n];
  }
  for (std::size_t n = 0; best && n < group.size(); ++n) complex_.mesh.tissues[group[n]] = *best;
  pieces_ = find_pieces(complex_);
  return best.has_value();
}

// Neighbourhoods of what is singular are given to one tissue each, as long as that leaves fewer defects.
void PatchMender::untangle(int max_rings, double max_price) {
  for (int rings = 1; rings <= max_rings && !singular_.empty();) {
    bool united = false;
    for (const VertexId v : singular_) {
      if (star_defect(complex_, v) > 0) united = unite(tets_around(v, rings), max_price) || united;
    }
    singular_ = singular_among(complex_, inner_vertices());
    if (!united) ++rings;
  }
}

double PatchMender::price(TetId t, TissueId tissue) const {
  return tissue != 0 && is_bad_[t] ? 2 * kTooDear : price_in_voxels_(t, tissue);
}

}  // namespace

std::vector<char> vote(TissueMesh& mesh, const TissueImage& part, const std::vector<char>& is_changed,
                       const ShapeBounds& bounds) {
  const LabelField field(part);
  std::vector<char> asked(mesh.tets.size(), 0);
  std::vector<TissueId> tissues(mesh.tets.size());
  parallel_for(
      mesh.tets.size(),
      [&](std::size_t t) {
        const auto id = static_cast<TetId>(t);
        bool is_asked = false;
        const TissueId tissue = voted(mesh, id, field, is_changed, is_asked);
        asked[t] = is_asked;
        const bool stays = mesh.tissues[t] == 0 && tissue != 0 && !is_within(mesh, id, bounds);
        tissues[t] = stays ? TissueId{0} : tissue;
      },
      64);
  mesh.tissues = std::move(tissues);
  clean_labels(mesh, [&](TetId t) { return asked[t] && (mesh.tissues[t] != 0 || is_within(mesh, t, bounds)); });
  return asked;
}

std::optional<MendFailure> mend_labels(TissueMesh& mesh, const LabelMending& mending, const Stage& stage) {
  return PatchMender(mesh, mending).run(stage);
}

}  // namespace anatomesh
