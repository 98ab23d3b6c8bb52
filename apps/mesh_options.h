// The options of image_to_mesh() on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/label_list.h"
#include "anatomesh/mesh_request.h"
#include "anatomesh/options.h"

namespace anatomesh::apps {

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

/// Fills in Options::labels. Throws InvalidOption when an option names a label that the image has not.
void resolve_labels(Options& options, const std::vector<LabelRange>& ranges, const LabelCounts& present);

/// Names such as "min_dihedral_deg" in a message of the library, replaced by the option's, "--min-dihedral".
std::string with_option_names(std::string_view message);

}  // namespace anatomesh::apps
