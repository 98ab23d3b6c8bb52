// The options of image_to_mesh() on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/materials.h"
#include "anatomesh/options.h"
#include "apps/label_list.h"

namespace anatomesh::apps {

/// What the user asked for, before the image is known.
struct MeshRequest {
  Options options;                 ///< without labels and without the materials of single tissues
  std::optional<double> fidelity;  ///< as given; else the default, or 1 within a budget of elements
  std::vector<LabelRange> ranges;
  std::map<Label, TissueKind> kinds;  ///< whose materials come from the table of the literature
  std::map<Label, double> young_modulus_pa;
  std::map<Label, double> poisson_ratio;
};

/// Adds an option for every member of Options, under the member's name without its unit.
void add_mesh_options(CLI::App& command, MeshRequest& request);

/// The three bounds that `mesh` keeps and `check` verifies; both commands write them the same way.
void add_bound_options(CLI::App& command, double& min_dihedral_deg, double& max_dihedral_deg, double& min_mean_ratio);

/// --frame
void add_frame_option(CLI::App& command, Frame& frame);

/// --order
void add_order_option(CLI::App& command, const std::string& help, int& order);

/// --labels
CLI::Option& add_labels_option(CLI::App& command, std::vector<LabelRange>& ranges);

/// The options with the materials of single tissues put together.
Options options_of(const MeshRequest& request);

/// Fills in Options::labels. Throws InvalidOption when an option names a label that the image has not.
void resolve_labels(Options& options, const std::vector<LabelRange>& ranges, const LabelCounts& present);

/// Names such as "min_dihedral_deg" in a message of the library, replaced by the option's, "--min-dihedral".
std::string with_option_names(std::string_view message);

}  // namespace anatomesh::apps
