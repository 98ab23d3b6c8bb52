#include "apps/json_report.h"

#include <nlohmann/json.hpp>

#include "anatomesh/version.h"

namespace anatomesh {

using Json = nlohmann::ordered_json;  // NaN becomes null in it

// One function a struct, named after its members. JSON's library finds it through the struct's namespace, so it
// must stand there and not in an unnamed one.

void to_json(Json& json, const Vec3& v) { json = {v.x, v.y, v.z}; }

void to_json(Json& json, const Quality& v) {
  json = {{"tets", v.tets},
          {"vertices", v.vertices},
          {"edges", v.edges},
          {"min_dihedral_deg", v.min_dihedral_deg},
          {"max_dihedral_deg", v.max_dihedral_deg},
          {"dihedral_p0_1_deg", v.dihedral_p0_1_deg},
          {"dihedral_p1_deg", v.dihedral_p1_deg},
          {"dihedral_p5_deg", v.dihedral_p5_deg},
          {"dihedral_median_deg", v.dihedral_median_deg},
          {"share_below_5_deg", v.share_below_5_deg},
          {"share_below_10_deg", v.share_below_10_deg},
          {"share_below_15_deg", v.share_below_15_deg},
          {"share_above_165_deg", v.share_above_165_deg},
          {"dihedral_histogram", v.dihedral_histogram},
          {"min_mean_ratio", v.min_mean_ratio},
          {"mean_mean_ratio", v.mean_mean_ratio},
          {"min_scaled_jacobian", v.min_scaled_jacobian},
          {"mean_scaled_jacobian", v.mean_scaled_jacobian},
          {"max_gradation", v.max_gradation},
          {"gradation_p99", v.gradation_p99},
          {"min_edge_mm", v.min_edge_mm},
          {"mean_edge_mm", v.mean_edge_mm},
          {"max_edge_mm", v.max_edge_mm},
          {"max_edge_ratio", v.max_edge_ratio},
          {"volume_mm3", v.volume_mm3},
          {"inverted", v.inverted},
          {"degenerate", v.degenerate}};
}

void to_json(Json& json, const Conformity& v) {
  json = {{"negative_orientation", v.negative_orientation},
          {"background_tets", v.background_tets},
          {"faces", v.faces},
          {"outer_faces", v.outer_faces},
          {"faces_in_more_than_two_tets", v.faces_in_more_than_two_tets},
          {"folded_tets", v.folded_tets},
          {"duplicate_vertices", v.duplicate_vertices},
          {"unused_vertices", v.unused_vertices},
          {"hanging_vertices", v.hanging_vertices},
          {"outer_faces_with_material_outside", v.outer_faces_with_material_outside},
          {"voxel_centres_in_several_tets", v.voxel_centres_in_several_tets}};
}

void to_json(Json& json, const Curves& v) {
  json = {{"tets", v.tets},
          {"curved_tets", v.curved_tets},
          {"folded", v.folded},
          {"min_jacobian", v.min_jacobian},
          {"min_dihedral_deg", v.min_dihedral_deg},
          {"max_dihedral_deg", v.max_dihedral_deg}};
}

void to_json(Json& json, const OneWayDistance& v) {
  json = {{"mean_mm", v.mean_mm}, {"p95_mm", v.p95_mm}, {"max_mm", v.max_mm}};
}

void to_json(Json& json, const SurfaceDistance& v) {
  json = {{"mesh_to_image", v.mesh_to_image},
          {"image_to_mesh", v.image_to_mesh},
          {"mean_mm", v.mean_mm},
          {"p95_mm", v.p95_mm},
          {"max_mm", v.max_mm}};
}

void to_json(Json& json, const Fidelity& v) {
  json = {{"image_voxels", v.image_voxels},
          {"mesh_voxels", v.mesh_voxels},
          {"common_voxels", v.common_voxels},
          {"f1", v.f1},
          {"f2", v.f2},
          {"dice", v.dice},
          {"image_volume_mm3", v.image_volume_mm3},
          {"volume_error_percent", v.volume_error_percent},
          {"distance", v.distance}};
}

void to_json(Json& json, const Topology& v) {
  json = {{"tet_components", v.tet_components},
          {"volume_euler", v.volume_euler},
          {"surface_vertices", v.surface_vertices},
          {"surface_edges", v.surface_edges},
          {"surface_faces", v.surface_faces},
          {"surface_area_mm2", v.surface_area_mm2},
          {"surface_components", v.surface_components},
          {"surface_euler", v.surface_euler},
          {"closed", v.closed},
          {"odd_edges", v.odd_edges},
          {"nonmanifold_edges", v.nonmanifold_edges},
          {"nonmanifold_vertices", v.nonmanifold_vertices},
          {"pinch_vertices", v.pinch_vertices},
          {"normal_jump_mean_deg", v.normal_jump_mean_deg},
          {"normal_jump_p95_deg", v.normal_jump_p95_deg},
          {"image_components_6", v.image_components_6},
          {"image_components_26", v.image_components_26},
          {"image_euler", v.image_euler}};
}

void to_json(Json& json, const TissueAssessment& v) {
  json = {{"label", v.label},     {"in_mesh", v.in_mesh},   {"in_image", v.in_image},
          {"quality", v.quality}, {"fidelity", v.fidelity}, {"topology", v.topology}};
}

void to_json(Json& json, const Summary& v) {
  json = {{"labels_in_image", v.labels_in_image},
          {"labels_in_mesh", v.labels_in_mesh},
          {"missing_labels", v.missing_labels},
          {"extra_labels", v.extra_labels},
          {"open_surfaces", v.open_surfaces},
          {"nonmanifold_edges", v.nonmanifold_edges},
          {"nonmanifold_vertices", v.nonmanifold_vertices},
          {"pinch_vertices", v.pinch_vertices},
          {"normal_jump_mean_deg", v.normal_jump_mean_deg},
          {"min_dice", v.min_dice},
          {"mean_dice", v.mean_dice},
          {"voxels_right", v.voxels_right},
          {"worst_volume_error_percent", v.worst_volume_error_percent},
          {"component_mismatches_6", v.component_mismatches_6},
          {"component_mismatches_26", v.component_mismatches_26},
          {"euler_mismatches", v.euler_mismatches},
          {"surface_mean_mm", v.surface_mean_mm},
          {"surface_p95_mean_mm", v.surface_p95_mean_mm},
          {"surface_p95_worst_mm", v.surface_p95_worst_mm},
          {"surface_max_mm", v.surface_max_mm}};
}

void to_json(Json& json, const Assessment& v) {
  json = {{"has_image", v.has_image},   {"has_distances", v.has_distances},
          {"conformity", v.conformity}, {"curves", v.curves},
          {"whole", v.whole},           {"summary", v.summary},
          {"tissues", v.tissues}};
  if (v.has_image) return;
  json["whole"]["fidelity"] = nullptr;
  for (Json& tissue : json["tissues"]) tissue["fidelity"] = nullptr;
}

NLOHMANN_JSON_SERIALIZE_ENUM(Frame, {{Frame::lps, "lps"}, {Frame::ras, "ras"}})
NLOHMANN_JSON_SERIALIZE_ENUM(FidelityStage, {{FidelityStage::lattice, "lattice"}, {FidelityStage::final, "final"}})
NLOHMANN_JSON_SERIALIZE_ENUM(NonConnectivity, {{NonConnectivity::vertex, "vertex"},
                                               {NonConnectivity::edge, "edge"},
                                               {NonConnectivity::face, "face"},
                                               {NonConnectivity::none, "none"}})

void to_json(Json& json, const Material& v) {
  json = {{"young_modulus_pa", v.young_modulus_pa}, {"poisson_ratio", v.poisson_ratio}};
}

void to_json(Json& json, const LatticeOptions& v) {
  json = {{"bcc_size_mm", v.bcc_size_mm},   {"min_size_mm", v.min_size_mm},
          {"fidelity", v.fidelity},         {"fidelity_stage", v.fidelity_stage},
          {"max_elements", v.max_elements}, {"elements_across", v.elements_across},
          {"drop_islands", v.drop_islands}, {"allow_non_manifold", v.allow_non_manifold}};
  json["size_label"] = Json::array();
  for (const auto& [label, size] : v.size_label) json["size_label"].push_back({{"label", label}, {"size_mm", size}});
  json["fidelity_label"] = Json::array();
  for (const auto& [label, fidelity] : v.fidelity_label)
    json["fidelity_label"].push_back({{"label", label}, {"fidelity", fidelity}});
}

void to_json(Json& json, const DeformOptions& v) {
  json = {{"non_connectivity", v.non_connectivity}, {"iterations", v.iterations},
          {"min_dihedral_deg", v.min_dihedral_deg}, {"max_dihedral_deg", v.max_dihedral_deg},
          {"min_mean_ratio", v.min_mean_ratio},     {"gradation", v.gradation},
          {"default_material", v.default_material}};
  json["material"] = Json::array();
  for (const auto& [label, material] : v.material) {
    Json entry = {{"label", label}};
    entry.update(Json(material));
    json["material"].push_back(entry);
  }
}

void to_json(Json& json, const Options& v) {
  json = {{"lattice", v.lattice},
          {"deform", v.deform},
          {"labels", v.labels},
          {"frame", v.frame},
          {"order", v.order},
          {"threads", v.threads},
          {"max_memory_gib", v.max_memory_gib}};
}

void to_json(Json& json, const AssessOptions& v) {
  json = {{"frame", v.frame},
          {"distances", v.distances},
          {"min_dihedral_deg", v.min_dihedral_deg},
          {"max_dihedral_deg", v.max_dihedral_deg},
          {"min_mean_ratio", v.min_mean_ratio}};
}

void to_json(Json& json, const TissueOutcome& v) {
  json = {{"label", v.label},           {"voxels", v.voxels},         {"tets", v.tets}, {"fidelity", v.fidelity},
          {"lattice_f1", v.lattice_f1}, {"lattice_f2", v.lattice_f2}, {"f1", v.f1},     {"f2", v.f2}};
}

void to_json(Json& json, const StageTime& v) { json = {{"stage", v.stage}, {"seconds", v.seconds}}; }

void to_json(Json& json, const LabelImage& v) {
  json = {{"size", v.size}, {"spacing_mm", v.spacing_mm}, {"origin_mm", v.origin_mm}, {"direction", v.direction}};
}

namespace apps {
namespace {

Json program() { return {{"name", "anatomesh"}, {"version", version()}}; }

/// "file" for an image of one, "files" for one of several masks.
Json files_json(const std::vector<std::filesystem::path>& paths) {
  if (paths.size() == 1) return {{"file", paths.front().string()}};
  Json files = Json::array();
  for (const auto& path : paths) files.push_back(path.string());
  return {{"files", files}};
}

/// Puts the name behind the label of each tissue; null where it is not known.
Json with_names(const Json& tissues, const LabelTable& names) {
  Json named = Json::array();
  for (const Json& tissue : tissues) {
    const auto label = tissue.at("label").get<Label>();
    const auto entry = names.find(label);
    Json changed = {{"label", label}, {"name", nullptr}};
    if (entry != names.end() && !entry->second.name.empty()) changed["name"] = entry->second.name;
    changed.update(tissue);
    named.push_back(changed);
  }
  return named;
}

Json assessment_json(const Assessment& assessment, const LabelTable& names) {
  Json json = assessment;
  json["tissues"] = with_names(json["tissues"], names);
  return json;
}

/// Text of a document; file names that are not UTF-8 lose their odd bytes rather than the report.
std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

std::string mesh_report_json(const MeshReport& report) {
  const MeshSummary& summary = report.summary;
  const Result& result = *summary.result;
  const LabelTable& names = report.image.image.names;
  Json image = report.image.image;
  image.update(files_json(summary.image_files));
  image["notes"] = report.image.notes;
  const Json mesh = {{"file", summary.mesh_file.string()},
                     {"bytes", summary.mesh_bytes},
                     {"tets", result.mesh.tets.size()},
                     {"vertices", result.mesh.points_mm.size()}};
  return text_of({{"program", program()},
                  {"image", image},
                  {"mesh", mesh},
                  {"options", result.options},
                  {"tissues", with_names(result.tissues, names)},
                  {"times", summary.times},
                  {"warnings", result.warnings},
                  {"assessment", assessment_json(report.assessment, names)}});
}

std::string check_json(const CheckReport& report) {
  Json json = {{"program", program()}, {"mesh", {{"file", report.mesh_file.string()}}}};
  json["image"] = report.image_files.empty() ? Json() : files_json(report.image_files);
  json["options"] = report.options;
  json["failed_guarantees"] = report.failures;
  json["assessment"] = assessment_json(report.assessment, report.names);
  return text_of(json);
}

}  // namespace apps
}  // namespace anatomesh
