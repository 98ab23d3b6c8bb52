#include <Anatomesh/MeshOptions.h>

#include <array>
#include <cstdint>
#include <regex>
#include <utility>

#include "anatomesh/errors.h"

namespace anatomesh::simulation {
namespace {

using sofa::core::objectmodel::BaseData;

/// Members of Options as the library's messages name them; the longer ones first.
constexpr std::array<std::pair<const char*, const char*>, 21> kDataNames = {{
    {"default_material young_modulus_pa", "young"},
    {"default_material poisson_ratio", "poisson"},
    {"bcc_size_mm", "bccSize"},
    {"min_size_mm", "minSize"},
    {"fidelity_label", "fidelityLabel"},
    {"fidelity_stage", "fidelityStage"},
    {"max_elements", "maxElements"},
    {"size_label", "sizeLabel"},
    {"elements_across", "elementsAcross"},
    {"drop_islands", "dropIslands"},
    {"allow_non_manifold", "allowNonManifold"},
    {"non_connectivity", "nonConnectivity"},
    {"min_dihedral_deg", "minDihedral"},
    {"max_dihedral_deg", "maxDihedral"},
    {"min_mean_ratio", "minMeanRatio"},
    {"young_modulus_pa", "young"},
    {"poisson_ratio", "poisson"},
    {"max_memory_gib", "maxMemory"},
    {"bcc_size", "bccSize"},
    {"min_size", "minSize"},
    {"max_memory", "maxMemory"},
}};

[[noreturn]] void rethrow_named(const BaseData& data, const InvalidOption& error) {
  throw InvalidOption(data.getName() + ": " + error.what());
}

/// `parse` of the Data's text.
template <class Parse>
auto parsed(const sofa::core::objectmodel::Data<std::string>& data, const Parse& parse) {
  try {
    return parse(data.getValue());
  } catch (const InvalidOption& error) {
    rethrow_named(data, error);
  }
}

std::uint64_t count_of(const sofa::core::objectmodel::Data<long>& data) {
  if (data.getValue() >= 0) return static_cast<std::uint64_t>(data.getValue());
  throw InvalidOption(data.getName() + " is " + std::to_string(data.getValue()) + "; it must be at least 0");
}

}  // namespace

MeshOptions::MeshOptions(sofa::core::objectmodel::BaseObject& component)
    : d_bccSize(component.initData(&d_bccSize, 0., "bccSize",
                                   "spacing of the coarsest lattice, mm; 0: 8 to 16 times the mean voxel spacing")),
      d_minSize(component.initData(&d_minSize, 0., "minSize",
                                   "smallest lattice spacing that fidelity may ask for, mm; 0: an eighth of bccSize, "
                                   "or half the mean voxel spacing without it")),
      d_fidelity(component.initData(&d_fidelity, 0.95, "fidelity",
                                    "fidelity that each tissue is refined for, 0 < F <= 1; 1 with maxElements unless "
                                    "given")),
      d_fidelityLabel(component.initData(&d_fidelityLabel, "fidelityLabel", "fidelity of single tissues: LABEL=F")),
      d_fidelityStage(component.initData(&d_fidelityStage, std::string("final"), "fidelityStage",
                                         "judge fidelity on the final mesh, or on the undeformed lattice: "
                                         "final|lattice")),
      d_maxElements(component.initData(&d_maxElements, 0L, "maxElements",
                                       "most tetrahedra; the best fidelity that they allow; 0: no limit")),
      d_sizeLabel(component.initData(&d_sizeLabel, "sizeLabel", "largest edge inside single tissues: LABEL=MM")),
      d_elementsAcross(component.initData(&d_elementsAcross, 0, "elementsAcross",
                                          "tetrahedra across a tissue where it is thin; 0: not asked")),
      d_dropIslands(component.initData(&d_dropIslands, 0L, "dropIslands",
                                       "drop parts of a tissue of fewer voxels than this; 0: none")),
      d_allowNonManifold(component.initData(&d_allowNonManifold, false, "allowNonManifold",
                                            "leave edges with more than two faces of a tissue's surface")),
      d_nonConnectivity(component.initData(&d_nonConnectivity, std::string("face"), "nonConnectivity",
                                           "thinning of the boundary's edge points: vertex|edge|face|none")),
      d_iterations(component.initData(&d_iterations, 10, "iterations", "deformation iterations; 0 keeps the lattice")),
      d_gradation(component.initData(&d_gradation, 0., "gradation",
                                     "mm that edges may be longer a mm farther from the surfaces; 0: no limit")),
      d_minDihedral(component.initData(&d_minDihedral, 20., "minDihedral", "smallest dihedral angle, 0 to 30 degrees")),
      d_maxDihedral(
          component.initData(&d_maxDihedral, 150., "maxDihedral", "largest dihedral angle, 117 to 180 degrees")),
      d_minMeanRatio(component.initData(&d_minMeanRatio, 0.3, "minMeanRatio", "smallest mean ratio, 0 to 0.5")),
      d_labels(component.initData(&d_labels, "labels", "these labels only, e.g. 1,2,5-9; the rest is background")),
      d_frame(component.initData(&d_frame, std::string("lps"), "frame", "space of the mesh: lps|ras")),
      d_threads(component.initData(&d_threads, 0, "threads", "threads; 0 takes all cores")),
      d_maxMemory(component.initData(&d_maxMemory, 0., "maxMemory",
                                     "refuse a mesh that takes more GiB by estimate; 0: the memory that is free")) {}

std::vector<BaseData*> MeshOptions::all() {
  return {&d_bccSize,         &d_minSize,    &d_fidelity,       &d_fidelityLabel, &d_fidelityStage,
          &d_maxElements,     &d_sizeLabel,  &d_elementsAcross, &d_dropIslands,   &d_allowNonManifold,
          &d_nonConnectivity, &d_iterations, &d_gradation,      &d_minDihedral,   &d_maxDihedral,
          &d_minMeanRatio,    &d_labels,     &d_frame,          &d_threads,       &d_maxMemory};
}

MeshRequest MeshOptions::request() const {
  MeshRequest request;
  LatticeOptions& lattice = request.options.lattice;
  lattice.bcc_size_mm = d_bccSize.getValue();
  lattice.min_size_mm = d_minSize.getValue();
  if (d_fidelity.isSet()) request.fidelity = d_fidelity.getValue();
  add_each(d_fidelityLabel, request, add_fidelity_label);
  lattice.fidelity_stage = parsed(d_fidelityStage, parse_fidelity_stage);
  lattice.max_elements = count_of(d_maxElements);
  add_each(d_sizeLabel, request, add_size_label);
  lattice.elements_across = d_elementsAcross.getValue();
  lattice.drop_islands = count_of(d_dropIslands);
  lattice.allow_non_manifold = d_allowNonManifold.getValue();
  DeformOptions& deform = request.options.deform;
  deform.non_connectivity = parsed(d_nonConnectivity, parse_non_connectivity);
  deform.iterations = d_iterations.getValue();
  deform.gradation = d_gradation.getValue();
  deform.min_dihedral_deg = d_minDihedral.getValue();
  deform.max_dihedral_deg = d_maxDihedral.getValue();
  deform.min_mean_ratio = d_minMeanRatio.getValue();
  if (!d_labels.getValue().empty()) request.ranges = parsed(d_labels, parse_label_list);
  request.options.frame = parsed(d_frame, parse_frame);
  request.options.threads = d_threads.getValue();
  request.options.max_memory_gib = d_maxMemory.getValue();
  return request;
}

void add_each(const sofa::core::objectmodel::Data<sofa::type::vector<std::string>>& data, MeshRequest& request,
              void (*add)(MeshRequest&, std::string_view)) {
  try {
    for (const std::string& text : data.getValue()) add(request, text);
  } catch (const InvalidOption& error) {
    rethrow_named(data, error);
  }
}

std::string with_data_names(std::string_view message) {
  std::string text(message);
  for (const auto& [member, data] : kDataNames)
    text = std::regex_replace(text, std::regex(std::string("\\b").append(member).append("\\b")), data);
  return text;
}

}  // namespace anatomesh::simulation
