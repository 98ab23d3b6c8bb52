#include "anatomesh/remesher.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "base/stage.h"
#include "base/vec.h"
#include "image/components.h"
#include "mesh/vertices_by_point.h"
#include "pipeline/checks.h"
#include "pipeline/local_update.h"
#include "pipeline/meshing.h"
#include "pipeline/outcome.h"
#include "pipeline/patch_weights.h"

namespace anatomesh {
namespace {

// Of the progress, before all is meshed anew.
constexpr double kLocalShare = 0.2;

// Everything but the voxels.
LabelImage grid_of(const LabelImage& image) {
  return {image.size, image.spacing_mm, image.origin_mm, image.direction, {}, image.names};
}

void check_same_grid(const LabelImage& image, const LabelImage& grid) {
  const char* what = image.size != grid.size               ? "size"
                     : image.spacing_mm != grid.spacing_mm ? "spacing"
                     : image.origin_mm != grid.origin_mm   ? "origin"
                     : image.direction != grid.direction   ? "direction"
                                                           : nullptr;
  if (what != nullptr)
    throw InvalidInput(std::string("the changed image has another ") + what +
                       " than the one before; it must have the same grid");
}

// The mesh and the background around it as one; where they meet, vertices have the same coordinates.
TissueMesh joined(const TissueMesh& mesh, const TissueMesh& beyond) {
  TissueMesh all = mesh;
  VerticesByPoint border;
  const std::vector<char> is_border = border_vertices(mesh);
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    if (is_border[v]) border.add(mesh.points_mm[v], v);
  }
  std::vector<VertexId> number(beyond.points_mm.size());
  for (std::size_t v = 0; v < number.size(); ++v) {
    const Vec3& p = beyond.points_mm[v];
    const auto same = border.at(p);
    number[v] = same ? *same : static_cast<VertexId>(all.points_mm.size());
    if (!same) all.points_mm.push_back(p);
  }
  for (std::array<VertexId, 4> tet : beyond.tets) {
    for (VertexId& v : tet) v = number[v];
    all.tets.push_back(tet);
    all.tissues.push_back(0);
  }
  return all;
}

// The numbers that labels have among all.
std::vector<TissueId> numbers_in(const std::vector<Label>& all, const std::vector<Label>& labels) {
  std::vector<TissueId> numbers;
  for (const Label label : labels)
    numbers.push_back(static_cast<TissueId>(std::ranges::lower_bound(all, label) - all.begin()));
  return numbers;
}

void renumber(TissueImage& image, const std::vector<Label>& all) {
  if (image.labels == all) return;
  const std::vector<TissueId> number = numbers_in(all, image.labels);
  for (TissueId& t : image.voxels) t = number[t];
  std::vector<std::uint64_t> counts(all.size(), 0);
  for (std::size_t t = 0; t < number.size(); ++t) counts[number[t]] = image.counts[t];
  image.counts = std::move(counts);
  image.labels = all;
}

// From the numbers of some labels to those of others; what has none goes.
template <class T>
void renumber(std::vector<T>& of_tissue, const std::vector<Label>& from, const std::vector<Label>& to) {
  std::vector<T> result(to.size());
  for (std::size_t t = 0; t < to.size(); ++t) {
    const auto old = std::ranges::lower_bound(from, to[t]);
    if (old != from.end() && *old == to[t]) result[t] = of_tissue[static_cast<std::size_t>(old - from.begin())];
  }
  of_tissue = std::move(result);
}

// Also the numbers of the mesh; the labels of its tetrahedra are among the others, too.
void renumber(KeptMesh& kept, const std::vector<Label>& from, const std::vector<Label>& to) {
  if (from == to) return;
  const std::vector<TissueId> number = numbers_in(to, from);
  for (TissueId& t : kept.mesh.tissues) t = number[t];
  renumber(kept.fidelity, from, to);
  renumber(kept.inside, from, to);
  renumber(kept.volume_mm3, from, to);
  renumber(kept.surface_mm, from, to);
  renumber(kept.area_mm2, from, to);
  renumber(kept.pieces_off, from, to);
}

// Where they differ; the same numbers mean the same in both.
void find_changes(ImageChange& change) {
  const TissueImage &a = change.before, &b = change.after;
  std::array<std::int64_t, 3> low, high;
  for (std::size_t n = 0; n < 3; ++n) {
    low[n] = std::min(a.first[n], b.first[n]);
    high[n] = std::max(a.first[n] + a.size[n], b.first[n] + b.size[n]);
  }
  // Rows are compared as a whole where the crops are the same, as they mostly are.
  const bool same_crop = a.first == b.first && a.size == b.size;
  const auto row_differs = [&](std::int64_t j, std::int64_t k) {
    if (!same_crop) return true;
    const std::size_t begin = a.offset(0, static_cast<int>(j - a.first[1]), static_cast<int>(k - a.first[2]));
    const auto from = a.voxels.begin() + static_cast<std::ptrdiff_t>(begin);
    return !std::equal(from, from + a.size[0], b.voxels.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  const auto at = [](const TissueImage& image, std::int64_t i, std::int64_t j, std::int64_t k) {
    return image.at_or_background(static_cast<int>(i - image.first[0]), static_cast<int>(j - image.first[1]),
                                  static_cast<int>(k - image.first[2]));
  };
  std::vector<std::vector<std::array<std::int64_t, 3>>> slices(static_cast<std::size_t>(high[2] - low[2]));
  parallel_for(
      slices.size(),
      [&](std::size_t s) {
        const std::int64_t k = low[2] + static_cast<std::int64_t>(s);
        for (std::int64_t j = low[1]; j < high[1]; ++j) {
          if (!row_differs(j, k)) continue;
          for (std::int64_t i = low[0]; i < high[0]; ++i) {
            if (at(a, i, j, k) != at(b, i, j, k)) slices[s].push_back({i, j, k});
          }
        }
      },
      1);
  for (const auto& slice : slices) change.voxels.insert(change.voxels.end(), slice.begin(), slice.end());
  if (change.voxels.empty()) return;
  change.box.low = change.box.high = change.voxels.front();
  for (const auto& voxel : change.voxels) {
    for (std::size_t n = 0; n < 3; ++n) {
      change.box.low[n] = std::min(change.box.low[n], voxel[n]);
      change.box.high[n] = std::max(change.box.high[n], voxel[n] + 1);
    }
  }
}

// Options that no local update follows.
std::string not_local(const Options& options) {
  if (options.deform.iterations == 0) return "iterations is 0, which keeps the lattice";
  if (options.lattice.fidelity_stage != FidelityStage::final) return "fidelity_stage is lattice";
  if (options.lattice.max_elements > 0) return "max_elements is given";
  if (options.lattice.elements_across > 0) return "elements_across is given";
  if (options.lattice.allow_non_manifold) return "allow_non_manifold is given";
  if (!options.lattice.size_label.empty()) return "size_label is given";
  if (options.deform.gradation > 0) return "gradation is given";
  return {};
}

// Labels that are named but gone from the image are no fault of the caller's.
Options for_labels(const Options& options, const LabelImage& image) {
  Options left = options;
  const auto is_gone = [&](Label label) { return std::ranges::find(image.voxels, label) == image.voxels.end(); };
  std::erase_if(left.labels, is_gone);
  std::erase_if(left.lattice.fidelity_label, [&](const auto& entry) { return is_gone(entry.first); });
  std::erase_if(left.lattice.size_label, [&](const auto& entry) { return is_gone(entry.first); });
  std::erase_if(left.deform.material, [&](const auto& entry) { return is_gone(entry.first); });
  if (left.labels.empty() && !options.labels.empty())
    throw InvalidInput("no voxel of the changed image has one of the chosen labels");
  return left;
}

}  // namespace

class Remesher::Impl {
 public:
  Impl(const LabelImage& image, const Options& options, const Progress& progress)
      : options_(options), grid_(grid_of(image)) {
    check_options(options);
    const ThreadLimit threads(options.threads);
    mesh_whole(image, options, progress);
  }

  UpdateReport update(const LabelImage& changed, const Progress& progress);
  const Result& result() const { return result_; }

 private:
  void mesh_whole(const LabelImage& image, const Options& options, const Progress& progress);
  void take(TissueImage image, const std::vector<Label>& numbered, std::vector<std::string> warnings);
  bool update_here(const LabelImage& changed, UpdateReport& report, const Progress& progress);

  Options options_;
  LabelImage grid_;
  TissueImage image_;
  std::vector<std::uint8_t> weights_;  // of the image's surface field
  KeptMesh kept_;
  Result result_;
  std::vector<TissueOutcome> lattice_;  // of the last whole meshing
};

void Remesher::Impl::mesh_whole(const LabelImage& image, const Options& options, const Progress& progress) {
  Meshing made = mesh_image(image, options, not_local(options).empty(), progress);
  KeptMesh kept;
  kept.mesh = joined(made.deformed.mesh, made.deformed.beyond);
  kept.fidelity = std::move(made.deformed.final.tissues);
  kept.inside = std::move(made.deformed.final.inside);
  measure_kept(kept, made.image);
  kept_ = std::move(kept);
  image_ = std::move(made.image);
  weights_ = std::move(made.deformed.voxel_weights);
  result_ = std::move(made.result);
  lattice_ = result_.tissues;
}

// The new state of things, after a local update in the numbers of these labels.
void Remesher::Impl::take(TissueImage image, const std::vector<Label>& numbered, std::vector<std::string> warnings) {
  std::vector<Label> labels = {0};
  for (std::size_t t = 1; t < numbered.size(); ++t) {
    if (image.counts[t] > 0) labels.push_back(numbered[t]);
  }
  if (labels != numbered) {
    // Tissues that are gone have neither voxels nor tetrahedra: what their numbers become does not matter.
    renumber(kept_, numbered, labels);
    const std::vector<TissueId> number = numbers_in(labels, numbered);
    for (TissueId& t : image.voxels) t = number[t];
    renumber(image.counts, numbered, labels);
    image.labels = labels;
  }
  image_ = std::move(image);
  result_.mesh = finished_mesh(kept_.mesh, image_, grid_, options_);
  result_.tissues = describe_tissues(image_, wanted_fidelity(options_.lattice, labels),
                                     std::vector<Fidelity>(labels.size()), kept_.inside, kept_.mesh);
  for (TissueOutcome& tissue : result_.tissues) {
    const auto before = std::ranges::find(lattice_, tissue.label, &TissueOutcome::label);
    if (before == lattice_.end()) continue;
    tissue.lattice_f1 = before->lattice_f1;
    tissue.lattice_f2 = before->lattice_f2;
  }
  result_.warnings = std::move(warnings);
  describe_losses(result_.tissues, result_.warnings);
  describe_shrinkage(kept_.mesh, image_, result_.warnings);
  describe_shortfall(result_.tissues, result_.warnings);
}

bool Remesher::Impl::update_here(const LabelImage& changed, UpdateReport& report, const Progress& progress) {
  const Stage stage(progress, "update", 0, kLocalShare);
  const Options options = for_labels(options_, changed);
  TissueImage after = make_tissue_image(changed, options.labels);
  std::vector<std::string> warnings;
  describe_islands(drop_islands(after, options.lattice.drop_islands), after, warnings);
  std::vector<Label> all;
  std::ranges::set_union(image_.labels, after.labels, std::back_inserter(all));
  const std::vector<Label> before_labels = image_.labels;
  std::optional<TissueImage> renumbered;
  if (before_labels != all) renumber(renumbered.emplace(image_), all);
  const TissueImage& before = renumbered ? *renumbered : image_;
  renumber(after, all);
  ImageChange change = {before, after, {}, {}, {}};
  find_changes(change);
  report.changed_voxels = change.voxels.size();
  if (change.voxels.empty()) return true;
  report.reason = not_local(options_);
  if (!report.reason.empty()) return false;
  change.weights = updated_weights(before, weights_, after, change.box);
  KeptMesh kept = kept_;
  renumber(kept, before_labels, all);
  const LocalResult local = update_locally(kept, change, options_, wanted_fidelity(options_.lattice, all), stage);
  report.reason = local.failure;
  if (!local.failure.empty()) return false;
  report.new_tets = local.new_tets;
  stage.check_cancelled();
  kept_ = std::move(kept);
  weights_ = std::move(change.weights);
  take(std::move(after), all, std::move(warnings));
  return true;
}

UpdateReport Remesher::Impl::update(const LabelImage& changed, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  check_image(changed);
  check_same_grid(changed, grid_);
  const ThreadLimit threads(options_.threads);
  UpdateReport report;
  if (!update_here(changed, report, progress)) {
    Progress rest = progress;
    if (progress.report) {
      rest.report = [&](std::string_view stage, double share) {
        progress.report(stage, kLocalShare + (1 - kLocalShare) * share);
      };
    }
    mesh_whole(changed, for_labels(options_, changed), rest);
    report.whole = true;
    report.new_tets = result_.mesh.tets.size();
  }
  if (progress.report) progress.report("update", 1);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

Remesher::Remesher(const LabelImage& image, const Options& options, const Progress& progress)
    : impl_(std::make_unique<Impl>(image, options, progress)) {}
Remesher::~Remesher() = default;
Remesher::Remesher(Remesher&&) noexcept = default;
Remesher& Remesher::operator=(Remesher&&) noexcept = default;
UpdateReport Remesher::update(const LabelImage& changed, const Progress& progress) {
  return impl_->update(changed, progress);
}
const Result& Remesher::result() const { return impl_->result(); }

}  // namespace anatomesh
