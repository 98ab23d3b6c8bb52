// Names of labels: where they come from, and how tables show them.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <set>
#include <string>

#include "anatomesh/label_table.h"

namespace anatomesh::apps {

/// --names
void add_names_option(CLI::App& command, std::filesystem::path& file);

/// Reads the table; an empty path stands for none.
LabelTable read_names(const std::filesystem::path& file);

/// Puts what a table says of the labels that are present into names, in the place of what they say; what it leaves open
/// stays. Returns how many of the labels the table has.
std::size_t take_names(LabelTable& names, const LabelTable& table, const std::set<Label>& present);

/// A warning for a table that names none of the labels of the file; empty: it names some, or there is no table.
std::string foreign_table(const std::filesystem::path& table, std::size_t named, const std::string& file);

/// The name in one line, cut where it is very long; empty: not known.
std::string shown_name(const LabelTable& names, Label label);

}  // namespace anatomesh::apps
