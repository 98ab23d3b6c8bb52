#include "pipeline/checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "anatomesh/errors.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/rotation.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

struct Range {
  const char* option;
  double value, low, high;
  bool low_allowed, high_allowed;
};

void require(const Range& r) {
  const bool above = r.low_allowed ? r.value >= r.low : r.value > r.low;
  const bool below = r.high_allowed ? r.value <= r.high : r.value < r.high;
  if (above && below) return;
  const bool unbounded = std::isinf(r.high);
  std::string right = std::string(r.low_allowed ? "at least " : "above ") + text(r.low);
  if (!unbounded) right += std::string(r.high_allowed ? " and at most " : " and below ") + text(r.high);
  throw InvalidOption(std::string(r.option) + " is " + text(r.value) + "; it must be " + right);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Lengths beyond these lose the shape of tetrahedra to rounding.
constexpr double kMinSpacing = 1e-6, kMaxSpacing = 1e6, kFarthest = 1e8;

void require_label(const TissueImage& tissues, Label label, const char* option) {
  if (label != 0 && std::binary_search(tissues.labels.begin(), tissues.labels.end(), label)) return;
  throw InvalidOption(std::string(option) + " names label " + std::to_string(label) +
                      ", which is not among the labels to mesh");
}

double mean_of(Vec3 spacing_mm) { return (spacing_mm.x + spacing_mm.y + spacing_mm.z) / 3; }

void require_ordered_sizes(const LatticeOptions& l) {
  if (l.min_size_mm <= l.bcc_size_mm) return;
  throw InvalidOption("min_size_mm is " + text(l.min_size_mm) + "; it must be at most bcc_size_mm, " +
                      text(l.bcc_size_mm));
}

}  // namespace

void check_options(const Options& o) {
  const LatticeOptions& l = o.lattice;
  const DeformOptions& d = o.deform;
  std::vector<Range> ranges = {
      {"bcc_size_mm", l.bcc_size_mm, 0, kInfinity, true, false},
      {"min_size_mm", l.min_size_mm, 0, kInfinity, true, false},
      {"fidelity", l.fidelity, 0, 1, false, true},
      {"gradation", d.gradation, 0, kInfinity, true, false},
      {"elements_across", static_cast<double>(l.elements_across), 0, 16, true, true},
      {"iterations", static_cast<double>(d.iterations), 0, 1000, true, true},
      {"min_dihedral_deg", d.min_dihedral_deg, 0, 30, true, true},
      {"max_dihedral_deg", d.max_dihedral_deg, 117, 180, true, true},
      {"min_mean_ratio", d.min_mean_ratio, 0, 0.5, true, true},
      {"order", static_cast<double>(o.order), 1, 2, true, true},
      {"threads", static_cast<double>(o.threads), 0, 4096, true, true},
      {"max_memory_gib", o.max_memory_gib, 0, kInfinity, true, false},
      {"default_material young_modulus_pa", d.default_material.young_modulus_pa, 0, kInfinity, false, false},
      {"default_material poisson_ratio", d.default_material.poisson_ratio, 0, 0.5, true, false},
  };
  for (const auto& [label, size] : l.size_label) ranges.push_back({"size_label", size, 0, kInfinity, false, false});
  for (const auto& [label, fidelity] : l.fidelity_label)
    ranges.push_back({"fidelity_label", fidelity, 0, 1, false, true});
  for (const auto& [label, material] : d.material) {
    ranges.push_back({"young_modulus_pa", material.young_modulus_pa, 0, kInfinity, false, false});
    ranges.push_back({"poisson_ratio", material.poisson_ratio, 0, 0.5, true, false});
  }
  for (const Range& r : ranges) require(r);
  if (l.bcc_size_mm > 0) require_ordered_sizes(l);
  if (l.max_elements > 0 && l.fidelity_stage != FidelityStage::final)
    throw InvalidOption("max_elements is " + std::to_string(l.max_elements) +
                        "; it must be 0 unless fidelity_stage is final");
}

void check_image(const LabelImage& image) {
  double voxels = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (image.size[a] < 1) throw InvalidInput("the image has no voxels along axis " + std::to_string(a));
    const double s = image.spacing_mm[a];
    if (!(s >= kMinSpacing && s <= kMaxSpacing)) {
      throw InvalidInput("the voxel spacing along axis " + std::to_string(a) + " is " + text(s) +
                         " mm; it must be from " + text(kMinSpacing) + " to " + text(kMaxSpacing));
    }
    if (!(std::abs(image.origin_mm[a]) <= kFarthest * s)) {
      throw InvalidInput("the origin along axis " + std::to_string(a) + " is " + text(image.origin_mm[a]) +
                         " mm; it must be within " + text(kFarthest) + " voxels of 0, or angles are lost to rounding");
    }
    voxels *= static_cast<double>(image.size[a]);
  }
  if (voxels != static_cast<double>(image.voxels.size())) {
    throw InvalidInput("the image has " + std::to_string(image.voxels.size()) + " labels for " + text(voxels) +
                       " voxels; the numbers must be equal");
  }
  if (voxels > 4e9) throw InvalidInput("the image has " + text(voxels) + " voxels; at most 4e9 are possible");
  if (const double defect = deviation_from_orthonormal(image.direction); !(defect <= kDirectionTolerance)) {
    throw InvalidInput("the direction matrix is off a rotation by " + text(defect) +
                       "; its columns must be orthogonal unit vectors");
  }
}

Options with_sizes_filled_in(const Options& options, const LabelImage& image) {
  Options filled = options;
  LatticeOptions& lattice = filled.lattice;
  const double voxel_mm = mean_of(image.spacing_mm);
  const bool is_final = lattice.fidelity_stage == FidelityStage::final;
  const bool root_is_given = lattice.bcc_size_mm > 0;
  if (!root_is_given) lattice.bcc_size_mm = (is_final ? 16 : 8) * voxel_mm;
  if (lattice.min_size_mm == 0) {
    lattice.min_size_mm = !is_final ? lattice.bcc_size_mm / 4 : !root_is_given ? voxel_mm / 2 : lattice.bcc_size_mm / 8;
  }
  require_ordered_sizes(lattice);
  return filled;
}

void check_labels_exist(const Options& options, const TissueImage& tissues) {
  for (const Label label : options.labels) require_label(tissues, label, "labels");
  for (const auto& [label, fidelity] : options.lattice.fidelity_label) require_label(tissues, label, "fidelity_label");
  for (const auto& [label, size] : options.lattice.size_label) require_label(tissues, label, "size_label");
  for (const auto& [label, material] : options.deform.material) require_label(tissues, label, "material");
}

std::size_t tets_that_fit(const Options& options, const LabelImage& image, const TissueImage& tissues) {
  // Measured: what a tetrahedron of the lattice takes while the mesh deforms, and what the images beside it take.
  constexpr double kBytesPerTet = 650, kBytesPerVoxel = 9, kBytesPerCell = 1200;
  constexpr double kGib = 1024.0 * 1024 * 1024;
  const double limit_gib = options.max_memory_gib > 0 ? options.max_memory_gib : available_memory_gib();
  if (limit_gib == 0) return std::numeric_limits<std::size_t>::max();
  // The coarsest lattice covers the whole crop.
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a)
    cells *= tissues.size[a] * tissues.spacing_mm[a] / options.lattice.bcc_size_mm + 3;
  const double images_gib = static_cast<double>(tissues.voxels.size()) * kBytesPerVoxel / kGib;
  const double needed_gib = images_gib + cells * kBytesPerCell / kGib;
  if (needed_gib <= limit_gib) return static_cast<std::size_t>((limit_gib - images_gib) * kGib / kBytesPerTet);
  throw InvalidInput("meshing this image of " + std::to_string(image.voxels.size()) + " voxels would take about " +
                     text(std::ceil(needed_gib * 10) / 10) + " GiB of memory where " +
                     text(std::floor(limit_gib * 10) / 10) + " GiB may be used; take a larger bcc_size");
}

}  // namespace anatomesh
