#include "pipeline/local_update.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <utility>

#include "base/vec.h"
#include "boundary/surface_field.h"
#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/deform.h"
#include "deform/flip_interfaces.h"
#include "deform/improve.h"
#include "deform/improve_shapes.h"
#include "deform/interface_faces.h"
#include "deform/refine_edges.h"
#include "deform/settle.h"
#include "deform/slide_vertices.h"
#include "deform/volume_shifts.h"
#include "image/boundary_area.h"
#include "image/components.h"
#include "mesh/adjacency.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"
#include "pipeline/final_fidelity.h"
#include "pipeline/patch_labels.h"
#include "pipeline/patch_sizes.h"
#include "pipeline/patch_weights.h"
#include "pipeline/surface_sizes.h"

namespace anatomesh {
namespace {

constexpr int kReachBlocks = 2;  // of a change around it, blocks of voxels
// Each with finer surfaces where the one before lacked something, and with one ring more of tetrahedra around.
constexpr int kAttempts = 5, kMostRings = 3;
// Of the mesh: where so many tetrahedra were made in vain, there is no further attempt; a patch of the most is not
// tried at all.
constexpr double kWorthwhile = 0.4, kMost = 0.8;
constexpr double kFiner = 0.65, kFinest = 0.4;  // of the size before; of the mean voxel spacing
constexpr double kFinerThere = 0.45;            // the first of them at single places
constexpr int kMargin = 6;                      // voxels around the patch that the field looks at

// The box of the image around a change and the interfaces of a patch.
TissueImage box_around(const TissueImage& image, const IndexBox& change, const TissueMesh& mesh) {
  const MeshTopology topology = make_topology(mesh);
  std::array<std::int64_t, 3> first;
  std::array<int, 3> size;
  for (std::size_t a = 0; a < 3; ++a) {
    double low = static_cast<double>(change.low[a]), high = static_cast<double>(change.high[a] - 1);
    for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
      if (!topology.on_interface(v)) continue;
      low = std::min(low, mesh.points_mm[v][a] / image.spacing_mm[a]);
      high = std::max(high, mesh.points_mm[v][a] / image.spacing_mm[a]);
    }
    first[a] = static_cast<std::int64_t>(std::floor(low)) - kMargin;
    size[a] = static_cast<int>(static_cast<std::int64_t>(std::ceil(high)) + kMargin + 1 - first[a]);
  }
  return part_of(image, first, size);
}

// By voxel of a box: changed, or next to one that is.
std::vector<char> mark_changed(const TissueImage& part, const ImageChange& change) {
  std::vector<char> marked(part.voxels.size(), 0);
  for (const auto& voxel : change.voxels) {
    std::array<int, 3> at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = static_cast<int>(voxel[a] - part.first[a]);
    for (int n = 0; n < 27; ++n) {
      const int i = at[0] + n % 3 - 1, j = at[1] + n / 3 % 3 - 1, k = at[2] + n / 9 - 1;
      if (part.contains(i, j, k)) marked[part.offset(i, j, k)] = 1;
    }
  }
  return marked;
}

void give_number(TissueMesh& mesh, TissueId from, TissueId to) { std::ranges::replace(mesh.tissues, from, to); }

class LocalUpdate {
 public:
  LocalUpdate(KeptMesh& kept, const ImageChange& change, const Options& options, std::vector<double> wanted,
              const Stage& stage)
      : quiet_{{}, stage.cancel_token()},
        kept_(kept),
        change_(change),
        wanted_(std::move(wanted)),
        bounds_(bounds_of(options.deform)),
        progress_(stage),
        stage_(quiet_, "update", 0, 1),
        tissues_(change.after.labels.size()),
        air_(static_cast<TissueId>(tissues_)) {}

  LocalResult run();

 private:
  void choose_sizes();
  std::vector<double> wanted_volumes() const;
  void refine();
  std::optional<MendFailure> relabel();
  void deform();
  void improve();
  void settle_here(int sweeps);
  void as_tissue(bool background_too) {
    if (background_too)
      give_number(mesh_, 0, air_);
    else
      give_number(mesh_, air_, 0);
  }
  double voxel_mm() const {
    const Vec3 s = change_.after.spacing_mm;
    return (s.x + s.y + s.z) / 3;
  }
  double share_of_mesh() const {
    return static_cast<double>(patch_.tets.size()) / static_cast<double>(kept_.mesh.tets.size());
  }
  std::string hindrance() const;
  void compact();
  void take(int rings);
  void ask_for_finer(const std::vector<Vec3>& places_mm, const std::vector<char>& tissues);
  std::optional<KeptMesh> attempt(std::string& failure);
  bool is_within_bounds() const;
  std::vector<char> lacking(const KeptMesh& next) const;
  KeptMesh measured() const;
  std::vector<Fidelity> updated(const std::vector<Fidelity>& all, const std::vector<Fidelity>& before,
                                const std::vector<Fidelity>& after) const;

  Progress quiet_;
  KeptMesh& kept_;
  const ImageChange& change_;
  std::vector<double> wanted_;
  ShapeBounds bounds_;
  const Stage& progress_;
  Stage stage_;  // of the steps, which say nothing
  std::size_t tissues_;
  TissueId air_;  // the number of the background while it counts as a tissue
  MeshPatch patch_;
  TissueMesh mesh_;
  TissueImage part_;
  std::optional<SurfaceField> field_;
  std::optional<VolumeShifts> shifts_;
  std::vector<char> is_changed_;
  std::vector<FinePlace> fine_;
  std::optional<PatchSizes> sizes_;
  std::vector<double> surface_mm_, area_mm2_, wanted_mm3_;
};

// The size along a tissue's surface that image_to_mesh() would begin with, mm.
double first_size(const TissueImage& image, std::size_t tissue, double area_mm2, double wanted) {
  constexpr double kEdge = 0.9;
  const double thick = image.volume_mm3(tissue) / area_mm2;
  const double wrong = std::max(1e-3, 1 - wanted);
  return kEdge * spacing_for(std::min(wrong, wrong_layer_mm(image, wrong) / thick)) * thick;
}

// The tissues' boundaries in the changed image.
std::vector<double> changed_areas(const ImageChange& change, std::vector<double> areas_mm2) {
  std::array<std::int64_t, 3> first;
  std::array<int, 3> size;
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = change.box.low[a] - 1;
    size[a] = static_cast<int>(change.box.high[a] + 1 - first[a]);
  }
  const std::vector<double> gone = boundary_areas_mm2(part_of(change.before, first, size)),
                            come = boundary_areas_mm2(part_of(change.after, first, size));
  for (std::size_t t = 0; t < areas_mm2.size(); ++t) areas_mm2[t] += come[t] - gone[t];
  return areas_mm2;
}

// A tissue that the image has had before keeps the size of its surface, but for what it has become thinner.
void LocalUpdate::choose_sizes() {
  const TissueImage &before = change_.before, &after = change_.after;
  area_mm2_ = changed_areas(change_, kept_.area_mm2);
  surface_mm_ = kept_.surface_mm;
  for (std::size_t t = 1; t < tissues_; ++t) {
    if (after.counts[t] == 0) continue;
    const double size = first_size(after, t, area_mm2_[t], wanted_[t]);
    if (surface_mm_[t] == 0 || before.counts[t] == 0) {
      surface_mm_[t] = size;
    } else {
      surface_mm_[t] *= std::min(1.0, size / first_size(before, t, kept_.area_mm2[t], wanted_[t]));
    }
    surface_mm_[t] = std::max(surface_mm_[t], kFinest * voxel_mm());
  }
}

// The patch's tissues gain or lose what the image's do. Where the mesh was off by much, it is to be less.
std::vector<double> LocalUpdate::wanted_volumes() const {
  constexpr double kMuch = 0.003;
  const MeshTopology topology = make_topology(patch_.mesh);
  std::vector<double> wanted =
      enclosed_volumes(patch_.mesh, find_interface_faces(patch_.mesh, topology, part_), tissues_);
  for (std::size_t t = 1; t < tissues_; ++t) {
    wanted[t] += change_.after.volume_mm3(t) - change_.before.volume_mm3(t);
    const double off = kept_.volume_mm3[t] - change_.before.volume_mm3(t), may = kMuch * change_.after.volume_mm3(t);
    wanted[t] -= off > may ? off - may : off < -may ? off + may : 0;
  }
  return wanted;
}

// With the background as a tissue, so that it can become one.
void LocalUpdate::refine() {
  sizes_.emplace(part_, surface_mm_, is_changed_, fine_);
  as_tissue(true);
  MeshEditor editor(mesh_);
  const std::size_t most = 2 * editor.tissue_tets() + kept_.mesh.tets.size() / 4;
  refine_edges(
      editor, bounds_, [&](Vec3 p) { return sizes_->at(p); }, most, stage_);
  mesh_ = editor.result();
  as_tissue(false);
}

std::optional<MendFailure> LocalUpdate::relabel() {
  vote(mesh_, part_, is_changed_, bounds_);
  std::vector<char> counted(tissues_, 0);
  for (const TissueId t : patch_.mesh.tissues) counted[t] = 1;
  for (const TissueId t : mesh_.tissues) counted[t] = 1;
  for (std::size_t v = 0; v < is_changed_.size(); ++v) {
    if (is_changed_[v]) counted[part_.voxels[v]] = 1;
  }
  const RestPieces rest = find_rest_pieces(kept_.mesh, patch_, std::move(counted));
  const ImageComponents components(change_.after);
  const LabelMending mending = {change_.after,         components,       part_,  rest,
                                patch_.mesh.points_mm, kept_.pieces_off, bounds_};
  return mend_labels(mesh_, mending, stage_);
}

void LocalUpdate::settle_here(int sweeps) {
  const std::vector<char> fixed = border_vertices(mesh_);
  const MeshTopology topology = make_topology(mesh_);
  const AngleGuard guard(mesh_, topology, bounds_, fixed);
  settle(mesh_, topology, guard, *field_, sweeps, *shifts_, stage_);
}

void LocalUpdate::deform() {
  MeshEditor editor(mesh_);
  split_bridges(editor, bounds_, stage_);
  mesh_ = in_spatial_order(editor.result());
  settle_here(6);
}

// As improve() does for a whole mesh.
void LocalUpdate::improve() {
  const auto coarsen_to = [&](const ShapeBounds& bounds) {
    as_tissue(true);
    MeshEditor editor(mesh_);
    CoarsenLimits limits;
    limits.bounds = bounds;
    coarsen(editor, *field_, limits, 10, stage_);
    improve_shapes(editor, bounds_, kEnoughSlack, stage_);
    mesh_ = editor.result();
    as_tissue(false);
  };
  coarsen_to(tightened(bounds_, kEarlyMarginDeg));
  for (int n = 0; n < 3; ++n) {
    MeshEditor editor(mesh_);
    flip_interfaces(editor, *field_, bounds_, stage_);
    improve_shapes(editor, bounds_, kEnoughSlack, stage_);
    mesh_ = editor.result();
    settle_here(4);
  }
  for (int n = 0; n < 2; ++n) coarsen_to(bounds_);
  MeshEditor editor(mesh_);
  for (int n = 0; n < 2; ++n) {
    slide_vertices(editor, *field_, bounds_, kSlidingSlack, stage_);
    improve_shapes(editor, bounds_, kEnoughSlack, stage_);
  }
  mesh_ = editor.result();
}

bool LocalUpdate::is_within_bounds() const {
  for (TetId t = 0; t < mesh_.tets.size(); ++t) {
    const auto& [a, b, c, d] = mesh_.tets[t];
    if (mesh_.tissues[t] != 0 &&
        !within(bounds_, mesh_.points_mm[a], mesh_.points_mm[b], mesh_.points_mm[c], mesh_.points_mm[d]))
      return false;
  }
  return true;
}

// Voxels that are not in the patch count in neither.
std::vector<Fidelity> LocalUpdate::updated(const std::vector<Fidelity>& all, const std::vector<Fidelity>& before,
                                           const std::vector<Fidelity>& after) const {
  std::vector<Fidelity> result = all;
  for (std::size_t t = 1; t < tissues_; ++t) {
    result[t].in_tets = result[t].in_tets + after[t].in_tets - before[t].in_tets;
    result[t].hits = result[t].hits + after[t].hits - before[t].hits;
    result[t].voxels = change_.after.counts[t];
  }
  return result;
}

// The tissues that have less fidelity than asked for, or a volume farther from the image's than may be, and had not
// before.
std::vector<char> LocalUpdate::lacking(const KeptMesh& next) const {
  constexpr double kNoWorse = 0.003, kMostOff = 0.01;
  constexpr std::uint64_t kMany = 1000;  // voxels; the volume of smaller tissues follows from their fidelity
  const auto reached = [](const Fidelity& f) { return std::min(f.f1(), f.f2()); };
  const auto off = [](double volume, double wanted) { return wanted > 0 ? std::abs(volume / wanted - 1) : 0; };
  std::vector<char> lacks(tissues_, 0);
  for (std::size_t t = 1; t < tissues_; ++t) {
    if (change_.after.counts[t] == 0) continue;
    const double now = reached(next.inside[t]), before = reached(kept_.inside[t]);
    const double is_off = off(next.volume_mm3[t], change_.after.volume_mm3(t)),
                 was_off = off(kept_.volume_mm3[t], change_.before.volume_mm3(t));
    lacks[t] = (now < wanted_[t] && !(before > 0 && before < wanted_[t] && now > before - kNoWorse)) ||
               (change_.after.counts[t] >= kMany && is_off > std::max(kMostOff, was_off + kNoWorse));
  }
  return lacks;
}

// What is known of the mesh with the patch as it is now.
KeptMesh LocalUpdate::measured() const {
  const TissueImage old = part_of(change_.before, part_.first, part_.size);
  const MeshFidelity before = measure_fidelity(patch_.mesh, old, stage_),
                     after = measure_fidelity(mesh_, part_, stage_);
  KeptMesh next;
  next.fidelity = updated(kept_.fidelity, before.tissues, after.tissues);
  next.inside = updated(kept_.inside, before.inside, after.inside);
  next.volume_mm3 = kept_.volume_mm3;
  const std::vector<double> gone = tissue_volumes_mm3(patch_.mesh, tissues_),
                            come = tissue_volumes_mm3(mesh_, tissues_);
  for (std::size_t t = 0; t < tissues_; ++t) next.volume_mm3[t] += come[t] - gone[t];
  next.surface_mm = kept_.surface_mm;
  next.area_mm2 = area_mm2_;
  next.pieces_off = kept_.pieces_off;
  next.box = kept_.box;
  return next;
}

// Where surfaces were singular, and of these tissues, edges are to be shorter.
void LocalUpdate::ask_for_finer(const std::vector<Vec3>& places_mm, const std::vector<char>& tissues) {
  for (const Vec3& p : places_mm) fine_.push_back({p, std::max(kFinerThere * sizes_->at(p), kFinest * voxel_mm())});
  for (std::size_t t = 1; t < tissues_; ++t) {
    if (tissues[t]) surface_mm_[t] = std::max(kFiner * surface_mm_[t], kFinest * voxel_mm());
  }
}

// What the mesh is like with the patch made anew; nothing where it lacks something.
std::optional<KeptMesh> LocalUpdate::attempt(std::string& failure) {
  mesh_ = patch_.mesh;
  shifts_.emplace(part_, wanted_mm3_);
  refine();
  if (const auto left = relabel()) {
    failure = left->singular_mm.empty()
                  ? "near the change a tissue would have had another number of parts than in the image"
                  : "near the change a surface could not be made manifold";
    ask_for_finer(left->singular_mm, left->miscounted);
    return std::nullopt;
  }
  deform();
  improve();
  KeptMesh next = measured();
  const std::vector<char> lacks = lacking(next);
  const auto worst = std::ranges::find(lacks, 1);
  if (worst == lacks.end() && is_within_bounds()) return next;
  failure = "near the change a tetrahedron could not be brought inside the bounds";
  if (worst != lacks.end()) {
    const Label label = change_.after.labels[static_cast<std::size_t>(worst - lacks.begin())];
    failure = "label " + std::to_string(label) + " would have had less than the fidelity asked for, or another volume";
  }
  ask_for_finer({}, lacks);
  return std::nullopt;
}

// Where nothing can be done, or nothing would be gained.
std::string LocalUpdate::hindrance() const {
  for (std::size_t a = 0; a < 3; ++a) {
    if (change_.box.low[a] < kept_.box.low[a] || change_.box.high[a] > kept_.box.high[a])
      return "the change goes beyond the background that is kept around the tissues";
  }
  if (tissues_ > std::numeric_limits<TissueId>::max()) return "the image has as many labels as are possible";
  return {};
}

LocalResult LocalUpdate::run() {
  LocalResult result;
  std::size_t spent = 0;  // tetrahedra made in vain
  result.failure = hindrance();
  if (!result.failure.empty()) return result;
  choose_sizes();
  compact();
  for (int n = 0; n < kAttempts; ++n) {
    progress_.at(static_cast<double>(n) / kAttempts);
    take(std::min(1 + n, kMostRings));
    if (share_of_mesh() > kMost) {
      result.failure = "the change reaches most of the mesh";
      break;
    }
    std::optional<KeptMesh> next = attempt(result.failure);
    if (!next) {
      spent += mesh_.tets.size();
      if (static_cast<double>(spent) > kWorthwhile * static_cast<double>(kept_.mesh.tets.size())) break;
      continue;
    }
    result.failure.clear();
    result.new_tets = tissue_tets(mesh_);
    next->mesh = std::move(kept_.mesh);
    next->unused_vertices = kept_.unused_vertices + put_patch(next->mesh, patch_, mesh_);
    kept_ = std::move(*next);
    break;
  }
  return result;
}

// Vertices that earlier updates have left behind.
void LocalUpdate::compact() {
  constexpr std::size_t kFew = 4;  // one in so many
  if (kept_.unused_vertices * kFew < kept_.mesh.points_mm.size()) return;
  kept_.mesh = with_cushion_last(kept_.mesh);
  kept_.unused_vertices = 0;
}

void LocalUpdate::take(int rings) {
  VoxelBlocks blocks(change_.box);
  for (const auto& voxel : change_.voxels) blocks.add(voxel);
  blocks.dilate(kReachBlocks);
  patch_ = take_patch(kept_.mesh, blocks, change_.after.spacing_mm, rings);
  part_ = box_around(change_.after, change_.box, patch_.mesh);
  is_changed_ = mark_changed(part_, change_);
  field_.emplace(part_, part_of(change_.after, change_.weights, part_.first, part_.size));
  wanted_mm3_ = wanted_volumes();
}

}  // namespace

namespace {

// Mean length of the edges between two vertices on interfaces, by tissue; 0 where there are none.
std::vector<double> surface_edges_mm(const TissueMesh& mesh, std::size_t tissues) {
  constexpr TissueId kNone = 0xffff;
  std::vector<TissueId> first(mesh.points_mm.size(), kNone);
  std::vector<char> on_interface(mesh.points_mm.size(), 0);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    for (const VertexId v : mesh.tets[t]) {
      if (first[v] == kNone) first[v] = mesh.tissues[t];
      on_interface[v] = on_interface[v] || first[v] != mesh.tissues[t];
    }
  }
  std::vector<double> sum(tissues, 0), count(tissues, 0);
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    for (const auto& [i, j] : kEdgeCorners) {
      if (!on_interface[tet[i]] || !on_interface[tet[j]]) continue;
      sum[mesh.tissues[t]] += norm(mesh.points_mm[tet[i]] - mesh.points_mm[tet[j]]);
      ++count[mesh.tissues[t]];
    }
  }
  for (std::size_t t = 0; t < tissues; ++t) sum[t] = t > 0 && count[t] > 0 ? sum[t] / count[t] : 0;
  return sum;
}

}  // namespace

void measure_kept(KeptMesh& kept, const TissueImage& image) {
  const std::size_t tissues = image.labels.size();
  kept.area_mm2 = boundary_areas_mm2(image);
  kept.unused_vertices = 0;
  kept.box = box_of(image);
  const std::vector<std::uint32_t> components = ImageComponents(image).count_by_tissue(tissues);
  const RestPieces pieces = find_rest_pieces(kept.mesh, {}, std::vector<char>(tissues, 1));
  kept.pieces_off.assign(tissues, 0);
  for (std::size_t t = 1; t < tissues; ++t)
    kept.pieces_off[t] = std::abs(static_cast<int>(pieces.closed[t]) - static_cast<int>(components[t]));
  kept.volume_mm3 = tissue_volumes_mm3(kept.mesh, tissues);
  kept.surface_mm = surface_edges_mm(kept.mesh, tissues);
}

LocalResult update_locally(KeptMesh& kept, const ImageChange& change, const Options& options,
                           std::vector<double> wanted, const Stage& stage) {
  return LocalUpdate(kept, change, options, std::move(wanted), stage).run();
}

}  // namespace anatomesh
