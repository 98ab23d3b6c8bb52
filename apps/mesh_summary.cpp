#include "apps/mesh_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "apps/label_names.h"
#include "apps/text_table.h"

namespace anatomesh::apps {
namespace {

std::string shell_quoted(const std::filesystem::path& path) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:=@";
  const std::string text = path.string();
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// "0.912 (label 23, putamen)": the tissue of the mesh whose value is worst.
std::string worst(const Result& result, double TissueOutcome::*value) {
  const std::vector<TissueOutcome>& tissues = result.tissues;
  const auto at = std::min_element(tissues.begin(), tissues.end(),
                                   [&](const auto& a, const auto& b) { return a.*value < b.*value; });
  if (at == tissues.end()) return "-";
  const std::string name = shown_name(result.mesh.names, at->label);
  return fmt::format("{} (label {}{}{})", fixed((*at).*value, 3), at->label, name.empty() ? "" : ", ", name);
}

/// "worst F1 0.951 (label 3), F2 0.912 (label 23); 2 of 41 tissues below their F". On the lattice
/// where that is what F was asked of.
std::string fidelity_line(const Result& result) {
  const bool final = result.options.lattice.fidelity_stage == FidelityStage::final;
  const auto f1 = final ? &TissueOutcome::f1 : &TissueOutcome::lattice_f1;
  const auto f2 = final ? &TissueOutcome::f2 : &TissueOutcome::lattice_f2;
  const auto short_of =
      std::ranges::count_if(result.tissues, [&](const auto& t) { return std::min(t.*f1, t.*f2) < t.fidelity; });
  return fmt::format("{}worst F1 {}, F2 {}; {} of {} tissues below their F",
                     final ? "" : "of the lattice: ", worst(result, f1), worst(result, f2), short_of,
                     result.tissues.size());
}

}  // namespace

std::string mesh_table(const MeshSummary& summary) {
  const Result& result = *summary.result;
  const ShapeSummary& shapes = summary.shapes;
  const auto meshed =
      std::count_if(result.tissues.begin(), result.tissues.end(), [](const auto& t) { return t.tets > 0; });
  double total_s = 0;
  std::string stages;
  for (const auto& [stage, seconds] : summary.times) {
    total_s += seconds;
    stages += fmt::format("{}{} {:.1f}", stages.empty() ? "" : ", ", stage, seconds);
  }
  const LatticeOptions& lattice = result.options.lattice;
  std::string text;
  text += field("mesh", fmt::format("{}, {}, {} frame in mm", summary.mesh_file.string(), byte_size(summary.mesh_bytes),
                                    result.options.frame == Frame::lps ? "LPS" : "RAS"));
  const char* kind = result.mesh.edge_nodes.empty() ? "" : " quadratic ones";
  text += field("tetrahedra", grouped(result.mesh.tets.size()) + kind);
  text += field("vertices", grouped(result.mesh.points_mm.size()));
  text += field("dihedral angles",
                fmt::format("{} to {} degrees", fixed(shapes.min_dihedral_deg, 2), fixed(shapes.max_dihedral_deg, 2)));
  text += field("mean ratio",
                fmt::format("{} smallest, {} mean", fixed(shapes.min_mean_ratio, 3), fixed(shapes.mean_mean_ratio, 3)));
  text += field("labels", fmt::format("{} of {} meshed", meshed, result.tissues.size()));
  text += field("lattice",
                fmt::format("{:.4g} mm, refined to at least {:.4g} mm", lattice.bcc_size_mm, lattice.min_size_mm));
  text += field("fidelity", fidelity_line(result));
  text += field("seconds", stages);
  text +=
      field("in all",
            fmt::format("{:.1f} s, {} tetrahedra a second", total_s,
                        grouped(static_cast<std::uint64_t>(static_cast<double>(result.mesh.tets.size()) / total_s))));
  std::string images;
  for (const auto& file : summary.image_files) images += " " + shell_quoted(file);
  const char* frame = result.options.frame == Frame::lps ? "" : " --frame ras";
  text += field("next", fmt::format("anatomesh check {} --image{}{}", shell_quoted(summary.mesh_file), images, frame));
  return text;
}

}  // namespace anatomesh::apps
