#include "apps/label_names.h"

#include <fmt/core.h>

#include "anatomesh/io.h"
#include "apps/text_table.h"

namespace anatomesh::apps {

void add_names_option(CLI::App& command, std::filesystem::path& file) {
  command
      .add_option("--names", file,
                  "names and colours of the labels: a table of 3D Slicer, FreeSurfer or ITK-SNAP, or label,name lines")
      ->type_name("FILE");
}

LabelTable read_names(const std::filesystem::path& file) {
  return file.empty() ? LabelTable() : read_label_table(file);
}

std::size_t take_names(LabelTable& names, const LabelTable& table, const std::set<Label>& present) {
  std::size_t named = 0;
  for (const auto& [label, entry] : table) {
    if (!present.contains(label)) continue;
    LabelEntry& own = names[label];
    if (!entry.name.empty()) own.name = entry.name;
    if (entry.colour) own.colour = entry.colour;
    ++named;
  }
  return named;
}

std::string foreign_table(const std::filesystem::path& table, std::size_t named, const std::string& file) {
  if (table.empty() || named > 0) return "";
  return fmt::format("'{}' names none of the labels of {}", table.string(), file);
}

std::string shown_name(const LabelTable& names, Label label) {
  constexpr std::size_t kLongest = 40;
  const auto entry = names.find(label);
  return entry == names.end() ? "" : shortened_to(kLongest, entry->second.name);
}

}  // namespace anatomesh::apps
