#include "assessment.h"

#include <pybind11/stl.h>

#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "anatomesh/assess.h"
#include "long_call.h"
#include "options.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

py::object dict(std::initializer_list<std::pair<const char*, py::object>> entries) {
  py::dict result;
  for (const auto& [key, value] : entries) result[key] = value;
  return result;
}

// One function a struct, named after its members; a test compares them with the report of the command line.

template <class Value>
py::object value(const Value& v) {
  return py::cast(v);
}

py::object value(double v) { return std::isnan(v) ? py::object(py::none()) : py::object(py::float_(v)); }

py::object value(const Quality& v) {
  return dict({{"tets", value(v.tets)},
               {"vertices", value(v.vertices)},
               {"edges", value(v.edges)},
               {"min_dihedral_deg", value(v.min_dihedral_deg)},
               {"max_dihedral_deg", value(v.max_dihedral_deg)},
               {"dihedral_p0_1_deg", value(v.dihedral_p0_1_deg)},
               {"dihedral_p1_deg", value(v.dihedral_p1_deg)},
               {"dihedral_p5_deg", value(v.dihedral_p5_deg)},
               {"dihedral_median_deg", value(v.dihedral_median_deg)},
               {"share_below_5_deg", value(v.share_below_5_deg)},
               {"share_below_10_deg", value(v.share_below_10_deg)},
               {"share_below_15_deg", value(v.share_below_15_deg)},
               {"share_above_165_deg", value(v.share_above_165_deg)},
               {"dihedral_histogram", value(v.dihedral_histogram)},
               {"min_mean_ratio", value(v.min_mean_ratio)},
               {"mean_mean_ratio", value(v.mean_mean_ratio)},
               {"min_scaled_jacobian", value(v.min_scaled_jacobian)},
               {"mean_scaled_jacobian", value(v.mean_scaled_jacobian)},
               {"max_gradation", value(v.max_gradation)},
               {"gradation_p99", value(v.gradation_p99)},
               {"min_edge_mm", value(v.min_edge_mm)},
               {"mean_edge_mm", value(v.mean_edge_mm)},
               {"max_edge_mm", value(v.max_edge_mm)},
               {"max_edge_ratio", value(v.max_edge_ratio)},
               {"volume_mm3", value(v.volume_mm3)},
               {"inverted", value(v.inverted)},
               {"degenerate", value(v.degenerate)}});
}

py::object value(const Conformity& v) {
  return dict({{"negative_orientation", value(v.negative_orientation)},
               {"background_tets", value(v.background_tets)},
               {"faces", value(v.faces)},
               {"outer_faces", value(v.outer_faces)},
               {"faces_in_more_than_two_tets", value(v.faces_in_more_than_two_tets)},
               {"folded_tets", value(v.folded_tets)},
               {"duplicate_vertices", value(v.duplicate_vertices)},
               {"unused_vertices", value(v.unused_vertices)},
               {"hanging_vertices", value(v.hanging_vertices)},
               {"outer_faces_with_material_outside", value(v.outer_faces_with_material_outside)},
               {"voxel_centres_in_several_tets", value(v.voxel_centres_in_several_tets)}});
}

py::object value(const Curves& v) {
  return dict({{"tets", value(v.tets)},
               {"curved_tets", value(v.curved_tets)},
               {"folded", value(v.folded)},
               {"min_jacobian", value(v.min_jacobian)},
               {"min_dihedral_deg", value(v.min_dihedral_deg)},
               {"max_dihedral_deg", value(v.max_dihedral_deg)}});
}

py::object value(const OneWayDistance& v) {
  return dict({{"mean_mm", value(v.mean_mm)}, {"p95_mm", value(v.p95_mm)}, {"max_mm", value(v.max_mm)}});
}

py::object value(const SurfaceDistance& v) {
  return dict({{"mesh_to_image", value(v.mesh_to_image)},
               {"image_to_mesh", value(v.image_to_mesh)},
               {"mean_mm", value(v.mean_mm)},
               {"p95_mm", value(v.p95_mm)},
               {"max_mm", value(v.max_mm)}});
}

py::object value(const Fidelity& v) {
  return dict({{"image_voxels", value(v.image_voxels)},
               {"mesh_voxels", value(v.mesh_voxels)},
               {"common_voxels", value(v.common_voxels)},
               {"f1", value(v.f1)},
               {"f2", value(v.f2)},
               {"dice", value(v.dice)},
               {"image_volume_mm3", value(v.image_volume_mm3)},
               {"volume_error_percent", value(v.volume_error_percent)},
               {"distance", value(v.distance)}});
}

py::object value(const Topology& v) {
  return dict({{"tet_components", value(v.tet_components)},
               {"volume_euler", value(v.volume_euler)},
               {"surface_vertices", value(v.surface_vertices)},
               {"surface_edges", value(v.surface_edges)},
               {"surface_faces", value(v.surface_faces)},
               {"surface_area_mm2", value(v.surface_area_mm2)},
               {"surface_components", value(v.surface_components)},
               {"surface_euler", value(v.surface_euler)},
               {"closed", value(v.closed)},
               {"odd_edges", value(v.odd_edges)},
               {"nonmanifold_edges", value(v.nonmanifold_edges)},
               {"nonmanifold_vertices", value(v.nonmanifold_vertices)},
               {"pinch_vertices", value(v.pinch_vertices)},
               {"normal_jump_mean_deg", value(v.normal_jump_mean_deg)},
               {"normal_jump_p95_deg", value(v.normal_jump_p95_deg)},
               {"image_components_6", value(v.image_components_6)},
               {"image_components_26", value(v.image_components_26)},
               {"image_euler", value(v.image_euler)}});
}

py::object value(const TissueAssessment& v) {
  return dict({{"label", value(v.label)},
               {"in_mesh", value(v.in_mesh)},
               {"in_image", value(v.in_image)},
               {"quality", value(v.quality)},
               {"fidelity", value(v.fidelity)},
               {"topology", value(v.topology)}});
}

py::object value(const Summary& v) {
  return dict({{"labels_in_image", value(v.labels_in_image)},
               {"labels_in_mesh", value(v.labels_in_mesh)},
               {"missing_labels", value(v.missing_labels)},
               {"extra_labels", value(v.extra_labels)},
               {"open_surfaces", value(v.open_surfaces)},
               {"nonmanifold_edges", value(v.nonmanifold_edges)},
               {"nonmanifold_vertices", value(v.nonmanifold_vertices)},
               {"pinch_vertices", value(v.pinch_vertices)},
               {"normal_jump_mean_deg", value(v.normal_jump_mean_deg)},
               {"min_dice", value(v.min_dice)},
               {"mean_dice", value(v.mean_dice)},
               {"voxels_right", value(v.voxels_right)},
               {"worst_volume_error_percent", value(v.worst_volume_error_percent)},
               {"component_mismatches_6", value(v.component_mismatches_6)},
               {"component_mismatches_26", value(v.component_mismatches_26)},
               {"euler_mismatches", value(v.euler_mismatches)},
               {"surface_mean_mm", value(v.surface_mean_mm)},
               {"surface_p95_mean_mm", value(v.surface_p95_mean_mm)},
               {"surface_p95_worst_mm", value(v.surface_p95_worst_mm)},
               {"surface_max_mm", value(v.surface_max_mm)}});
}

py::object value(const std::vector<TissueAssessment>& tissues) {
  py::list result;
  for (const TissueAssessment& tissue : tissues) result.append(value(tissue));
  return result;
}

py::object value(const Assessment& v) {
  return dict({{"has_image", value(v.has_image)},
               {"has_distances", value(v.has_distances)},
               {"conformity", value(v.conformity)},
               {"curves", value(v.curves)},
               {"whole", value(v.whole)},
               {"summary", value(v.summary)},
               {"tissues", value(v.tissues)}});
}

/// What compares with an image, and was not measured without one.
void leave_out_fidelity(const py::object& assessment) {
  assessment["whole"]["fidelity"] = py::none();
  for (const py::handle tissue : assessment["tissues"]) tissue["fidelity"] = py::none();
}

void add_names(const py::object& assessment, const LabelTable& names) {
  for (const py::handle tissue : assessment["tissues"]) {
    const auto entry = names.find(tissue["label"].cast<Label>());
    const bool is_named = entry != names.end() && !entry->second.name.empty();
    tissue["name"] = is_named ? py::object(py::str(entry->second.name)) : py::none();
  }
}

py::object assessed(const TetMesh& mesh, const LabelImage* image, const py::str& frame, bool distances,
                    double min_dihedral_deg, double max_dihedral_deg, double min_mean_ratio,
                    const py::object& progress) {
  const AssessOptions options = {frame_of(frame), distances, min_dihedral_deg, max_dihedral_deg, min_mean_ratio};
  Assessment assessment;
  do_long_work(progress, [&](const Progress& p) { assessment = assess(mesh, image, options, p); });
  const py::object result = value(assessment);
  add_names(result, mesh.names);
  if (!assessment.has_image) leave_out_fidelity(result);
  result["failed_guarantees"] = failed_guarantees(assessment, options);
  return result;
}

}  // namespace

void bind_assess(py::module_& module) {
  module.def("assess", &assessed, "mesh"_a, "image"_a.none(true), "frame"_a, "distances"_a, "min_dihedral_deg"_a,
             "max_dihedral_deg"_a, "min_mean_ratio"_a, "progress"_a);
}

}  // namespace anatomesh::python
