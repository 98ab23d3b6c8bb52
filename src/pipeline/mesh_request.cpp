#include "anatomesh/mesh_request.h"

#include <charconv>
#include <cmath>
#include <string>

#include "anatomesh/errors.h"

namespace anatomesh {
namespace {

double parse_real(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value)) return value;
  throw InvalidOption(std::string("'").append(text).append("' is not a finite number"));
}

/// The parts of "LABEL=VALUE"; without a label the value is meant for all others.
std::pair<std::optional<Label>, std::string_view> split_label(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return {std::nullopt, text};
  return {parse_label(text.substr(0, equals)), text.substr(equals + 1)};
}

/// As split_label(); throws `how` it is written where the label is missing.
std::pair<Label, std::string_view> require_split(std::string_view text, const char* how) {
  const auto [label, value] = split_label(text);
  if (!label) throw InvalidOption(how);
  return {*label, value};
}

template <class Enum, std::size_t Count>
Enum parse_choice(std::string_view text, const std::array<Choice<Enum>, Count>& choices) {
  std::string names;
  for (const auto& [word, value] : choices) {
    if (text == word) return value;
    names.append(names.empty() ? "" : "|").append(word);
  }
  throw InvalidOption(std::string("'").append(text).append("' is not one of ").append(names));
}

void add_property(std::string_view text, std::map<Label, double>& of_tissue, double& of_others) {
  const auto [label, value] = split_label(text);
  const double number = parse_real(value);
  (label ? of_tissue[*label] : of_others) = number;
}

}  // namespace

Frame parse_frame(std::string_view text) { return parse_choice(text, kFrames); }
int parse_order(std::string_view text) { return parse_choice(text, kOrders); }
FidelityStage parse_fidelity_stage(std::string_view text) { return parse_choice(text, kFidelityStages); }
NonConnectivity parse_non_connectivity(std::string_view text) { return parse_choice(text, kNonConnectivities); }

void add_fidelity_label(MeshRequest& request, std::string_view text) {
  const auto [label, value] = require_split(text, "write it as LABEL=F, e.g. 3=0.99");
  request.options.lattice.fidelity_label[label] = parse_real(value);
}

void add_size_label(MeshRequest& request, std::string_view text) {
  const auto [label, value] = require_split(text, "write it as LABEL=MM, e.g. 3=2.5");
  request.options.lattice.size_label[label] = parse_real(value);
}

void add_tissue(MeshRequest& request, std::string_view text) {
  const auto [label, value] = require_split(text, "write it as LABEL=KIND, e.g. 3=tumour");
  request.kinds[label] = parse_choice(value, kTissueKinds);
}

void add_young(MeshRequest& request, std::string_view text) {
  add_property(text, request.young_modulus_pa, request.options.deform.default_material.young_modulus_pa);
}

void add_poisson(MeshRequest& request, std::string_view text) {
  add_property(text, request.poisson_ratio, request.options.deform.default_material.poisson_ratio);
}

Options options_of(const MeshRequest& request) {
  Options options = request.options;
  DeformOptions& deform = options.deform;
  if (options.lattice.max_elements > 0) options.lattice.fidelity = 1;
  if (request.fidelity) options.lattice.fidelity = *request.fidelity;
  const auto material_of = [&](Label label) -> Material& {
    return deform.material.try_emplace(label, deform.default_material).first->second;
  };
  for (const auto& [label, kind] : request.kinds) deform.material[label] = default_material(kind);
  for (const auto& [label, young] : request.young_modulus_pa) material_of(label).young_modulus_pa = young;
  for (const auto& [label, poisson] : request.poisson_ratio) material_of(label).poisson_ratio = poisson;
  return options;
}

}  // namespace anatomesh
