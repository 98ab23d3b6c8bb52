#include "apps/mesh_options.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <regex>
#include <type_traits>
#include <utility>

#include "anatomesh/errors.h"

namespace anatomesh::apps {
namespace {

/// Members of Options as the library's messages name them.
constexpr std::array<std::pair<const char*, const char*>, 20> kOptionNames = {{
    {"default_material young_modulus_pa", "--young"},
    {"default_material poisson_ratio", "--poisson"},
    {"bcc_size_mm", "--bcc-size"},
    {"min_size_mm", "--min-size"},
    {"fidelity_label", "--fidelity-label"},
    {"fidelity_stage", "--fidelity-stage"},
    {"max_elements", "--max-elements"},
    {"size_label", "--size-label"},
    {"elements_across", "--elements-across"},
    {"drop_islands", "--drop-islands"},
    {"gradation", "--gradation"},
    {"non_connectivity", "--non-connectivity"},
    {"min_dihedral_deg", "--min-dihedral"},
    {"max_dihedral_deg", "--max-dihedral"},
    {"min_mean_ratio", "--min-mean-ratio"},
    {"young_modulus_pa", "--young"},
    {"poisson_ratio", "--poisson"},
    {"max_memory_gib", "--max-memory"},
    {"bcc_size", "--bcc-size"},
    {"min_size", "--min-size"},
}};

/// A finite real or a whole number. Throws InvalidOption.
template <class Number>
Number parse_number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole_text = error == std::errc() && end == text.data() + text.size();
  if constexpr (std::is_integral_v<Number>) {
    if (!whole_text) throw InvalidOption(fmt::format("'{}' is not a whole number", text));
  } else {
    if (!whole_text || !std::isfinite(value)) throw InvalidOption(fmt::format("'{}' is not a finite number", text));
  }
  return value;
}

/// An option whose text is handed to `take`; what is wrong with it is told with the option's name.
CLI::Option* add_parsed(CLI::App& command, const std::string& name, const std::string& value_name,
                        const std::string& help, const std::function<void(const std::string&)>& take) {
  const auto parse = [name, take](const std::string& text) {
    try {
      take(text);
    } catch (const InvalidOption& error) {
      throw CLI::ValidationError(name, error.what());
    }
  };
  return command.add_option_function<std::string>(name, parse, help)->type_name(value_name);
}

template <class Number>
void add_number(CLI::App& command, const std::string& name, const std::string& value_name, const std::string& help,
                Number& target) {
  add_parsed(command, name, value_name, help, [&](const std::string& text) { target = parse_number<Number>(text); });
}

/// An option that may be given several times, once a label.
void add_labelled(CLI::App& command, const std::string& name, const std::string& value_name, const std::string& help,
                  MeshRequest& request, void (*take)(MeshRequest&, std::string_view)) {
  add_parsed(command, name, value_name, help, [&request, take](const std::string& text) {
    take(request, text);
  })->trigger_on_parse();
}

template <class Choices>
std::string names_of(const Choices& choices) {
  std::string names;
  for (const auto& choice : choices) names.append(names.empty() ? "" : "|").append(choice.first);
  return names;
}

template <class Choices, class Enum>
void add_choice(CLI::App& command, const std::string& name, const std::string& help, const Choices& choices,
                Enum (*parse)(std::string_view), Enum& target) {
  add_parsed(command, name, names_of(choices), help,
             [&target, parse](const std::string& text) { target = parse(text); });
}

void add_lattice_options(CLI::App& command, MeshRequest& request) {
  LatticeOptions& lattice = request.options.lattice;
  add_number(
      command, "--bcc-size", "MM",
      "spacing of the coarsest lattice [8 to 16 times the mean voxel spacing, whatever suits the surfaces; 8 times "
      "with --fidelity-stage lattice]",
      lattice.bcc_size_mm);
  add_number(command, "--min-size", "MM",
             "smallest lattice spacing that fidelity may ask for [an eighth of --bcc-size, or half the mean voxel "
             "spacing without it; a quarter of --bcc-size with "
             "--fidelity-stage lattice]",
             lattice.min_size_mm);
  add_parsed(command, "--fidelity", "F", "fidelity that each tissue is refined for, 0 < F <= 1 [0.95]",
             [&request](const std::string& text) { request.fidelity = parse_number<double>(text); });
  add_choice(command, "--fidelity-stage",
             "judge fidelity on the final mesh, or on the undeformed lattice as the paper does [final]",
             kFidelityStages, parse_fidelity_stage, lattice.fidelity_stage);
  add_labelled(command, "--fidelity-label", "LABEL=F", "fidelity of one tissue; may be repeated", request,
               add_fidelity_label);
  add_number(command, "--max-elements", "N",
             "most tetrahedra; the best fidelity that they allow (--fidelity is 1 unless given); 0: no limit [0]",
             lattice.max_elements);
  add_labelled(command, "--size-label", "LABEL=MM", "largest edge inside one tissue; may be repeated", request,
               add_size_label);
  add_number(command, "--elements-across", "N", "tetrahedra across a tissue where it is thin; 0: not asked [0]",
             lattice.elements_across);
  add_number(command, "--drop-islands", "N", "drop parts of a tissue of fewer voxels than this; 0: none [0]",
             lattice.drop_islands);
  command.add_flag("--allow-non-manifold", lattice.allow_non_manifold,
                   "leave edges with more than two faces of a tissue's surface");
}

void add_deform_options(CLI::App& command, DeformOptions& deform) {
  add_choice(command, "--non-connectivity", "thinning of the boundary's edge points [face]", kNonConnectivities,
             parse_non_connectivity, deform.non_connectivity);
  add_number(command, "--iterations", "N", "deformation iterations; 0 keeps the lattice [10]", deform.iterations);
  add_number(command, "--gradation", "G",
             "mm that edges may be longer a mm farther from the surfaces, e.g. 0.5; 0: no limit [0]", deform.gradation);
  add_bound_options(command, deform.min_dihedral_deg, deform.max_dihedral_deg, deform.min_mean_ratio);
}

void add_material_options(CLI::App& command, MeshRequest& request) {
  add_labelled(command, "--tissue", "LABEL=" + names_of(kTissueKinds),
               "elastic material of one tissue, by its kind; may be repeated", request, add_tissue);
  add_labelled(command, "--young", "[LABEL=]PA", "Young's modulus of a tissue, or of all others [3000]", request,
               add_young);
  add_labelled(command, "--poisson", "[LABEL=]NU", "Poisson ratio of a tissue, or of all others [0.45]", request,
               add_poisson);
}

}  // namespace

void add_mesh_options(CLI::App& command, MeshRequest& request) {
  add_lattice_options(command, request);
  add_deform_options(command, request.options.deform);
  add_material_options(command, request);
  add_labels_option(command, request.ranges);
  add_frame_option(command, request.options.frame);
  add_order_option(command,
                   "1: linear tetrahedra, 2: quadratic ones, with nodes on their edges that follow the surfaces [1]",
                   request.options.order);
  add_number(command, "--threads", "N", "threads; 0 takes all cores [0]", request.options.threads);
  add_number(command, "--max-memory", "GIB",
             "refuse a mesh that takes more by estimate; 0 takes the memory that is free [0]",
             request.options.max_memory_gib);
}

void add_bound_options(CLI::App& command, double& min_dihedral_deg, double& max_dihedral_deg, double& min_mean_ratio) {
  add_number(command, "--min-dihedral", "DEG", "smallest dihedral angle, 0 to 30 [20]", min_dihedral_deg);
  add_number(command, "--max-dihedral", "DEG", "largest dihedral angle, 117 to 180 [150]", max_dihedral_deg);
  add_number(command, "--min-mean-ratio", "R", "smallest mean ratio of a tetrahedron, 0 to 0.5 [0.3]", min_mean_ratio);
}

void add_frame_option(CLI::App& command, Frame& frame) {
  add_choice(command, "--frame", "space of the mesh [lps]", kFrames, parse_frame, frame);
}

void add_order_option(CLI::App& command, const std::string& help, int& order) {
  add_choice(command, "--order", help, kOrders, parse_order, order);
}

CLI::Option& add_labels_option(CLI::App& command, std::vector<LabelRange>& ranges) {
  return *add_parsed(command, "--labels", "LIST", "these labels only, e.g. 1,2,5-9; the rest is background [all]",
                     [&](const std::string& text) { ranges = parse_label_list(text); });
}

void resolve_labels(Options& options, const std::vector<LabelRange>& ranges, const LabelCounts& present) {
  for (const auto& [label, fidelity] : options.lattice.fidelity_label)
    require_label(label, present, "--fidelity-label");
  for (const auto& [label, size] : options.lattice.size_label) require_label(label, present, "--size-label");
  for (const auto& [label, material] : options.deform.material)
    require_label(label, present, "--tissue, --young or --poisson");
  options.labels = select_labels(ranges, present, "--labels");
}

std::string with_option_names(std::string_view message) {
  std::string text(message);
  for (const auto& [member, option] : kOptionNames)
    text = std::regex_replace(text, std::regex(fmt::format("\\b{}\\b", member)), option);
  return text;
}

}  // namespace anatomesh::apps
