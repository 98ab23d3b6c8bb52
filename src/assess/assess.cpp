#include "anatomesh/assess.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/quadratic.h"
#include "assess/adjacency.h"
#include "assess/conformity.h"
#include "assess/curves.h"
#include "assess/quality.h"
#include "assess/rasterise.h"
#include "assess/surface.h"
#include "assess/surface_distance.h"
#include "assess/surface_topology.h"
#include "assess/tet_measures.h"
#include "assess/tissue_mesh.h"
#include "assess/voxel_block.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

using namespace assess_detail;

void check_image(const LabelImage& image) {
  const auto& size = image.size;
  const Vec3 spacing = image.spacing_mm;
  if (size[0] * size[1] * size[2] != image.voxels.size())
    throw InvalidInput("the image's size and its voxels disagree");
  if (!(spacing.x > 0 && spacing.y > 0 && spacing.z > 0)) throw InvalidInput("the image's spacing must be above 0");
  if (!(std::abs(determinant(image.direction)) > 1e-3)) throw InvalidInput("the image's axes do not span space");
}

/// What is known of the mesh before the tissues are looked at one by one.
struct Mesh {
  TissueMesh tissues;
  VertexStars stars;
  std::vector<TetMeasures> measures;
  Neighbours neighbours;
  std::vector<Skeleton> skeletons;        // of every tissue, then of the whole
  std::vector<std::uint64_t> components;  // likewise
};

/// The same of the image, and of both.
struct Image {
  Image(const LabelImage& image_, std::vector<Vec3> points_vox_) : image(image_), points_vox(std::move(points_vox_)) {}

  const LabelImage& image;
  std::vector<Vec3> points_vox;
  Coverage coverage;
};

/// Tells the caller how far the work is, and ends it when asked to.
class Watch {
 public:
  explicit Watch(const Progress& progress) : progress_(progress) {}

  void stage(const char* name, double fraction) const {
    if (progress_.cancel.stop_requested()) throw Cancelled();
    if (progress_.report) progress_.report(name, fraction);
  }

  /// May be called by any thread; only the caller's passes it on.
  void tissue_done(std::size_t of) {
    const auto done = static_cast<double>(++done_);
    if (std::this_thread::get_id() != caller_) return;
    stage(kTissues, kTissuesFrom + (1 - kTissuesFrom) * done / static_cast<double>(of));
  }

  static constexpr const char* kTissues = "surfaces";
  static constexpr double kTissuesFrom = 0.3;

 private:
  const Progress& progress_;
  std::atomic<std::size_t> done_ = 0;
  std::thread::id caller_ = std::this_thread::get_id();
};

Fidelity fidelity_of(const VoxelCounts& counts, double mesh_volume_mm3, double voxel_volume_mm3) {
  const auto ratio = [](std::uint64_t part, std::uint64_t whole) {
    return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  Fidelity f;
  f.image_voxels = counts.image;
  f.mesh_voxels = counts.mesh;
  f.common_voxels = counts.common;
  f.f1 = ratio(counts.common, counts.mesh);
  f.f2 = ratio(counts.common, counts.image);
  f.dice = ratio(2 * counts.common, counts.mesh + counts.image);
  f.image_volume_mm3 = static_cast<double>(counts.image) * voxel_volume_mm3;
  if (counts.image > 0) f.volume_error_percent = 100 * (mesh_volume_mm3 / f.image_volume_mm3 - 1);
  return f;
}

/// Faces among the tetrahedra, each counted once.
std::uint64_t count_inner_faces(std::span<const TetId> tets, Scope scope, const Mesh& mesh) {
  std::uint64_t sides = 0;
  for (const TetId t : tets) {
    for (const TetId u : mesh.neighbours.across[t]) {
      sides += u < kCrowded && (scope == Scope::whole || mesh.tissues.tissue_of[u] == mesh.tissues.tissue_of[t]);
    }
  }
  return sides / 2;
}

/// One tissue, or the whole: the tetrahedra and where their numbers stand in the tables.
struct Part {
  Scope scope;
  std::size_t number;  // in Mesh::skeletons and components
  Label label;         // 0 for the whole
  std::span<const TetId> tets;
};

Topology topology_of(const Part& part, const Mesh& mesh, std::span<const Triangle> surface) {
  Topology t;
  if (part.tets.empty()) return t;
  measure_surface(surface, mesh.tissues.points_mm, t);
  const Skeleton& skeleton = mesh.skeletons[part.number];
  t.tet_components = mesh.components[part.number];
  const std::uint64_t faces = count_inner_faces(part.tets, part.scope, mesh) + surface.size();
  t.volume_euler = static_cast<std::int64_t>(skeleton.vertices + faces) -
                   static_cast<std::int64_t>(skeleton.edges + part.tets.size());
  return t;
}

TissueAssessment assess_part(const Part& part, const Mesh& mesh, const Image* image, const AssessOptions& options,
                             const std::stop_token& cancel) {
  if (cancel.stop_requested()) throw Cancelled();
  TissueAssessment a;
  a.label = part.label;
  a.in_mesh = !part.tets.empty();
  a.quality =
      quality_of(part.tets, part.scope, mesh.tissues, mesh.measures, mesh.neighbours, mesh.skeletons[part.number]);
  const auto surface = surface_of(part.tets, part.scope, mesh.tissues, mesh.measures, mesh.neighbours);
  a.topology = topology_of(part, mesh, surface);
  if (image == nullptr) return a;

  const Coverage& coverage = image->coverage;
  const VoxelCounts& counts = part.scope == Scope::whole ? coverage.whole : coverage.tissues[part.number];
  const Vec3 spacing = image->image.spacing_mm;
  a.in_image = counts.image > 0;
  a.fidelity = fidelity_of(counts, a.quality.volume_mm3, spacing.x * spacing.y * spacing.z);
  if (!a.in_image) return a;
  const VoxelBlock block = cut_out(image->image, counts.range, part.label);
  a.topology.image_components_6 = count_components_6(block);
  a.topology.image_components_26 = count_components_26(block);
  a.topology.image_euler = euler_number(block);
  if (options.distances && !surface.empty()) {
    a.fidelity.distance = surface_distance(surface, image->points_vox, block, spacing, cancel);
  }
  return a;
}

/// The whole first, then the tissues: the larger ones early, so that no thread is left alone with one at the end.
std::vector<Part> list_parts(const TissueMesh& mesh) {
  std::vector<Part> parts = {{Scope::whole, mesh.tissue_count(), 0, mesh.by_tissue}};
  for (Tissue t = 0; t < mesh.tissue_count(); ++t) parts.push_back({Scope::tissue, t, mesh.labels[t], mesh.tets_of(t)});
  std::stable_sort(parts.begin() + 1, parts.end(),
                   [](const Part& a, const Part& b) { return a.tets.size() > b.tets.size(); });
  return parts;
}

Mesh prepare(const TetMesh& given, const std::vector<Label>& image_labels, const std::stop_token& cancel) {
  const auto go_on = [&] {
    if (cancel.stop_requested()) throw Cancelled();
  };
  Mesh mesh;
  mesh.tissues = make_tissue_mesh(given, image_labels);
  mesh.stars = make_vertex_stars(mesh.tissues);
  go_on();
  mesh.measures = measure_tets(mesh.tissues);
  go_on();
  mesh.neighbours = find_neighbours(mesh.tissues, mesh.stars);
  go_on();
  mesh.skeletons = find_skeletons(mesh.tissues, mesh.stars);
  go_on();
  mesh.components = count_components(mesh.tissues, mesh.neighbours);
  return mesh;
}

Conformity conformity_of(const Mesh& mesh) {
  const auto outer = surface_of(mesh.tissues.by_tissue, Scope::whole, mesh.tissues, mesh.measures, mesh.neighbours);
  return check_conformity(mesh.tissues, mesh.stars, mesh.neighbours, mesh.skeletons.back(), outer);
}

void sum_up_tissue(const TissueAssessment& t, bool has_image, Summary& s) {
  s.labels_in_image += t.in_image;
  s.labels_in_mesh += t.in_mesh;
  if (!t.in_mesh) s.missing_labels.push_back(t.label);
  if (has_image && !t.in_image) s.extra_labels.push_back(t.label);
  if (!t.topology.closed) s.open_surfaces.push_back(t.label);
  s.nonmanifold_edges += t.topology.nonmanifold_edges;
  s.nonmanifold_vertices += t.topology.nonmanifold_vertices;
  s.pinch_vertices += t.topology.pinch_vertices;
  if (t.in_image) s.min_dice = std::fmin(s.min_dice, t.fidelity.dice);
  if (!t.in_image || !t.in_mesh) return;
  s.worst_volume_error_percent = std::fmax(s.worst_volume_error_percent, std::abs(t.fidelity.volume_error_percent));
  s.component_mismatches_6 += t.topology.tet_components != t.topology.image_components_6;
  s.component_mismatches_26 += t.topology.tet_components != t.topology.image_components_26;
  s.euler_mismatches += t.topology.volume_euler != t.topology.image_euler;
  s.surface_p95_worst_mm = std::fmax(s.surface_p95_worst_mm, t.fidelity.distance.p95_mm);
  s.surface_max_mm = std::fmax(s.surface_max_mm, t.fidelity.distance.max_mm);
}

/// Mean of value(tissue) weighted by weight(tissue) over the tissues where the value exists.
template <class Value, class Weight>
double mean_over(const std::vector<TissueAssessment>& tissues, const Value& value, const Weight& weight) {
  double sum = 0, weights = 0;
  for (const TissueAssessment& t : tissues) {
    if (std::isnan(value(t))) continue;
    sum += weight(t) * value(t);
    weights += weight(t);
  }
  return weights > 0 ? sum / weights : kNotMeasured;
}

Summary sum_up(const std::vector<TissueAssessment>& tissues, const Image* image) {
  Summary s;
  for (const TissueAssessment& t : tissues) sum_up_tissue(t, image != nullptr, s);
  const auto one = [](const TissueAssessment&) { return 1.0; };
  const auto manifold_edges = [](const TissueAssessment& t) {
    return static_cast<double>(t.topology.surface_edges - t.topology.nonmanifold_edges);
  };
  const auto area = [](const TissueAssessment& t) { return t.topology.surface_area_mm2; };
  s.normal_jump_mean_deg = mean_over(
      tissues, [](const TissueAssessment& t) { return t.topology.normal_jump_mean_deg; }, manifold_edges);
  s.mean_dice = mean_over(
      tissues, [](const TissueAssessment& t) { return t.in_image ? t.fidelity.dice : kNotMeasured; }, one);
  s.surface_mean_mm = mean_over(
      tissues, [](const TissueAssessment& t) { return t.fidelity.distance.mean_mm; }, area);
  s.surface_p95_mean_mm = mean_over(
      tissues, [](const TissueAssessment& t) { return t.fidelity.distance.p95_mm; }, one);
  if (image != nullptr && image->coverage.whole.image > 0) {
    s.voxels_right = static_cast<double>(image->coverage.right) / static_cast<double>(image->coverage.whole.image);
  }
  return s;
}

}  // namespace

Assessment assess(const TetMesh& given, const LabelImage* image, const AssessOptions& options,
                  const Progress& progress) {
  if (!given.edge_nodes.empty()) {
    const Curves curves = measure_curves(given);
    Assessment result = assess(linear_mesh(given), image, options, progress);
    result.curves = curves;
    return result;
  }
  if (image != nullptr) check_image(*image);
  Assessment result;
  result.has_image = image != nullptr;
  result.has_distances = image != nullptr && options.distances;

  Watch watch(progress);
  watch.stage("quality", 0);
  const Mesh mesh = prepare(given, image == nullptr ? std::vector<Label>{} : labels_of(*image), progress.cancel);
  watch.stage("conformity", 0.1);
  result.conformity = conformity_of(mesh);
  std::optional<Image> seen;
  if (image != nullptr) {
    watch.stage("fidelity", 0.2);
    seen.emplace(*image, to_index_space(given.points_mm, *image, options.frame));
    seen->coverage = rasterise(mesh.tissues, seen->points_vox, *image, progress.cancel);
    result.conformity.voxel_centres_in_several_tets = seen->coverage.in_several;
  }
  const Image* against = seen ? &*seen : nullptr;

  watch.stage(Watch::kTissues, Watch::kTissuesFrom);
  const std::vector<Part> parts = list_parts(mesh.tissues);
  result.tissues.resize(mesh.tissues.tissue_count());
  parallel_for(
      parts.size(),
      [&](std::size_t i) {
        TissueAssessment& place = i == 0 ? result.whole : result.tissues[parts[i].number];
        place = assess_part(parts[i], mesh, against, options, progress.cancel);
        watch.tissue_done(parts.size());
      },
      1);
  result.summary = sum_up(result.tissues, against);
  return result;
}

}  // namespace anatomesh
