#include "apps/tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "apps/label_names.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

/// Up to this many tissues all have a row; of more only the worst.
constexpr std::size_t kFewTissues = 40;
constexpr std::size_t kWorstShown = 20;

struct TissueColumn {
  const char* title;
  std::function<std::string(const TissueAssessment&)> text;
};

const std::vector<TissueColumn>& quality_columns() {
  using T = TissueAssessment;
  static const std::vector<TissueColumn> all = {
      {"tets", [](const T& t) { return grouped(t.quality.tets); }},
      {"min deg", [](const T& t) { return fixed(t.quality.min_dihedral_deg, 2); }},
      {"max deg", [](const T& t) { return fixed(t.quality.max_dihedral_deg, 2); }},
      {"min ratio", [](const T& t) { return fixed(t.quality.min_mean_ratio, 3); }},
      {"mean ratio", [](const T& t) { return fixed(t.quality.mean_mean_ratio, 3); }},
      {"min jacobian", [](const T& t) { return fixed(t.quality.min_scaled_jacobian, 3); }},
      {"gradation", [](const T& t) { return fixed(t.quality.max_gradation, 1); }},
      {"mean edge mm", [](const T& t) { return fixed(t.quality.mean_edge_mm, 2); }},
      {"volume ml", [](const T& t) { return fixed(t.quality.volume_mm3 / 1000, 3); }},
  };
  return all;
}

const std::vector<TissueColumn>& fidelity_columns() {
  using T = TissueAssessment;
  static const std::vector<TissueColumn> all = {
      {"voxels", [](const T& t) { return grouped(t.fidelity.image_voxels); }},
      {"F1", [](const T& t) { return fixed(t.fidelity.f1, 3); }},
      {"F2", [](const T& t) { return fixed(t.fidelity.f2, 3); }},
      {"Dice", [](const T& t) { return fixed(t.fidelity.dice, 3); }},
      {"volume %", [](const T& t) { return fixed(t.fidelity.volume_error_percent, 1); }},
      {"mean mm", [](const T& t) { return fixed(t.fidelity.distance.mean_mm, 3); }},
      {"95 % mm", [](const T& t) { return fixed(t.fidelity.distance.p95_mm, 3); }},
      {"max mm", [](const T& t) { return fixed(t.fidelity.distance.max_mm, 2); }},
  };
  return all;
}

const std::vector<TissueColumn>& topology_columns() {
  using T = TissueAssessment;
  static const std::vector<TissueColumn> all = {
      {"parts", [](const T& t) { return grouped(t.topology.tet_components); }},
      {"in image", [](const T& t) { return grouped(t.topology.image_components_6); }},
      {"Euler", [](const T& t) { return std::to_string(t.topology.volume_euler); }},
      {"of image", [](const T& t) { return std::to_string(t.topology.image_euler); }},
      {"shells", [](const T& t) { return grouped(t.topology.surface_components); }},
      {"nm edges", [](const T& t) { return grouped(t.topology.nonmanifold_edges); }},
      {"nm vertices", [](const T& t) { return grouped(t.topology.nonmanifold_vertices); }},
      {"jump deg", [](const T& t) { return fixed(t.topology.normal_jump_mean_deg, 1); }},
      {"area cm2", [](const T& t) { return fixed(t.topology.surface_area_mm2 / 100, 2); }},
  };
  return all;
}

using TissuePointers = std::vector<const TissueAssessment*>;

/// The tissues to show, by label; the worst ones by Dice, or by smallest angle where there is no image.
TissuePointers chosen_tissues(const Assessment& assessment, TissueRows rows) {
  TissuePointers chosen;
  for (const TissueAssessment& tissue : assessment.tissues) chosen.push_back(&tissue);
  if (rows == TissueRows::all || chosen.size() <= kFewTissues) return chosen;
  const auto goodness = [&](const TissueAssessment* t) {
    if (assessment.has_image) return t->fidelity.dice;
    return std::isnan(t->quality.min_dihedral_deg) ? -1 : t->quality.min_dihedral_deg;
  };
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](const auto* a, const auto* b) { return goodness(a) < goodness(b); });
  chosen.resize(kWorstShown);
  return chosen;
}

std::string tissue_table(const std::vector<TissueColumn>& shown, const TissueAssessment& whole,
                         const TissuePointers& tissues, const LabelTable& names) {
  const bool has_names = std::ranges::any_of(
      tissues, [&](const TissueAssessment* tissue) { return !shown_name(names, tissue->label).empty(); });
  std::vector<std::string> titles = {"tissue"};
  if (has_names) titles.emplace_back(kNameTitle);
  for (const TissueColumn& column : shown) titles.emplace_back(column.title);
  std::vector<std::vector<std::string>> rows;
  const auto add_row = [&](const std::string& label, const std::string& name, const TissueAssessment& tissue) {
    rows.push_back({label});
    if (has_names) rows.back().push_back(name);
    for (const TissueColumn& column : shown) rows.back().push_back(column.text(tissue));
  };
  add_row("all", "", whole);
  for (const TissueAssessment* tissue : tissues)
    add_row(std::to_string(tissue->label), shown_name(names, tissue->label), *tissue);
  return columns(titles, rows);
}

std::string percent(double share) { return fixed(100 * share, 2) + " %"; }

/// One bar for each 5 degrees that has angles.
std::string dihedral_histogram(const Quality& quality) {
  constexpr double kLongest = 40;
  const auto& counts = quality.dihedral_histogram;
  const auto most = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
  std::string text;
  for (std::size_t bin = 0; bin < counts.size(); ++bin) {
    if (counts[bin] == 0) continue;
    const double share = static_cast<double>(counts[bin]) / (6 * static_cast<double>(quality.tets));
    const std::string bar(static_cast<std::size_t>(std::ceil(kLongest * static_cast<double>(counts[bin]) / most)), '#');
    text += fmt::format("  {:>3} to {:>3} deg {:>8}  {}\n", 5 * bin, 5 * bin + 5, percent(share), bar);
  }
  return text;
}

std::string quality_lines(const Quality& q) {
  std::string text;
  text += field("tetrahedra", fmt::format("{}, with {} vertices and {} edges", grouped(q.tets), grouped(q.vertices),
                                          grouped(q.edges)));
  text += field("dihedral angles",
                fmt::format("{} to {} degrees", fixed(q.min_dihedral_deg, 3), fixed(q.max_dihedral_deg, 3)));
  text += field("smallest angle",
                fmt::format("{} at 0.1 %, {} at 1 %, {} at 5 %, {} in the median", fixed(q.dihedral_p0_1_deg, 1),
                            fixed(q.dihedral_p1_deg, 1), fixed(q.dihedral_p5_deg, 1), fixed(q.dihedral_median_deg, 1)));
  text += field("bad angles", fmt::format("below 5 deg {}, 10 deg {}, 15 deg {}; above 165 deg {}",
                                          percent(q.share_below_5_deg), percent(q.share_below_10_deg),
                                          percent(q.share_below_15_deg), percent(q.share_above_165_deg)));
  text +=
      field("mean ratio", fmt::format("{} smallest, {} mean", fixed(q.min_mean_ratio, 3), fixed(q.mean_mean_ratio, 3)));
  text += field("scaled Jacobian",
                fmt::format("{} smallest, {} mean", fixed(q.min_scaled_jacobian, 3), fixed(q.mean_scaled_jacobian, 3)));
  text +=
      field("gradation", fmt::format("{} largest, {} at 99 %", fixed(q.max_gradation, 1), fixed(q.gradation_p99, 1)));
  text += field("edges", fmt::format("{} to {} mm, {} mean; up to {} in one tetrahedron", fixed(q.min_edge_mm, 3),
                                     fixed(q.max_edge_mm, 3), fixed(q.mean_edge_mm, 3), fixed(q.max_edge_ratio, 2)));
  text += field("inverted, flat", fmt::format("{}, {}", grouped(q.inverted), grouped(q.degenerate)));
  return text + dihedral_histogram(q);
}

/// Nothing of a linear mesh.
std::string curve_lines(const Curves& c) {
  if (c.tets == 0) return {};
  return field("quadratic",
               fmt::format("{} curved, least Jacobian {} of the straight one's, {} to {} degrees at corners",
                           grouped(c.curved_tets), fixed(c.min_jacobian, 3), fixed(c.min_dihedral_deg, 3),
                           fixed(c.max_dihedral_deg, 3)));
}

std::string fidelity_lines(const Assessment& a) {
  const Summary& s = a.summary;
  std::string text;
  text += field("labels",
                fmt::format("{} of {} in the mesh", s.labels_in_image - s.missing_labels.size(), s.labels_in_image));
  text += field("Dice", fmt::format("{} of all as one, {} smallest and {} mean of the tissues",
                                    fixed(a.whole.fidelity.dice, 3), fixed(s.min_dice, 3), fixed(s.mean_dice, 3)));
  text += field("voxels right", percent(s.voxels_right));
  text += field("volume error",
                fmt::format("{} % of all, {} % worst tissue", fixed(a.whole.fidelity.volume_error_percent, 2),
                            fixed(s.worst_volume_error_percent, 1)));
  if (a.has_distances)
    text += field("surface distance", fmt::format("{} mm mean, {} mm at 95 % (worst tissue {}), {} mm at most",
                                                  fixed(s.surface_mean_mm, 3), fixed(s.surface_p95_mean_mm, 3),
                                                  fixed(s.surface_p95_worst_mm, 3), fixed(s.surface_max_mm, 2)));
  return text;
}

std::string topology_lines(const Assessment& a) {
  const Conformity& c = a.conformity;
  const Summary& s = a.summary;
  std::string text;
  text += field("faces", fmt::format("{}, {} of them outer; {} in more than two tetrahedra", grouped(c.faces),
                                     grouped(c.outer_faces), grouped(c.faces_in_more_than_two_tets)));
  text += field("vertices", fmt::format("{} hanging, {} duplicate, {} unused", grouped(c.hanging_vertices),
                                        grouped(c.duplicate_vertices), grouped(c.unused_vertices)));
  text += field("non-manifold",
                fmt::format("{} edges and {} vertices over all tissues, {} of them pinches",
                            grouped(s.nonmanifold_edges), grouped(s.nonmanifold_vertices), grouped(s.pinch_vertices)));
  text += field("open surfaces", std::to_string(s.open_surfaces.size()));
  if (a.has_image)
    text += field("unlike the image", fmt::format("{} tissues in their number of parts, {} in their Euler number",
                                                  s.component_mismatches_6, s.euler_mismatches));
  return text;
}

}  // namespace

std::string assessment_tables(const Assessment& assessment, TissueRows rows, const LabelTable& names) {
  const TissuePointers tissues = chosen_tissues(assessment, rows);
  std::string heading;
  if (tissues.size() < assessment.tissues.size())
    heading = fmt::format("the {} worst of {} tissues by {} (--all shows all)\n", tissues.size(),
                          assessment.tissues.size(), assessment.has_image ? "Dice" : "angle");
  const auto section = [&](const char* name, const std::string& lines, const std::vector<TissueColumn>& shown) {
    return fmt::format("{}\n{}\n{}{}\n", name, lines, heading, tissue_table(shown, assessment.whole, tissues, names));
  };
  std::string text =
      section("QUALITY", curve_lines(assessment.curves) + quality_lines(assessment.whole.quality), quality_columns());
  if (assessment.has_image) text += section("FIDELITY", fidelity_lines(assessment), fidelity_columns());
  return text + section("TOPOLOGY", topology_lines(assessment), topology_columns());
}

}  // namespace anatomesh::apps
