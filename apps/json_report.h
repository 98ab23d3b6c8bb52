// What is measured of a mesh, as JSON: numbers as numbers, labels as integers, null for what was not measured.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomesh/assess.h"
#include "anatomesh/io.h"
#include "apps/mesh_summary.h"

namespace anatomesh::apps {

/// The report of `mesh`.
struct MeshReport {
  const MeshSummary& summary;
  const ImageFile& image;
  const Assessment& assessment;
};

std::string mesh_report_json(const MeshReport& report);

/// The report of `check`.
struct CheckReport {
  const std::filesystem::path& mesh_file;
  const std::vector<std::filesystem::path>& image_files;  ///< empty: none
  const AssessOptions& options;
  const Assessment& assessment;
  const std::vector<std::string>& failures;
  const LabelTable& names;
};

std::string check_json(const CheckReport& report);

}  // namespace anatomesh::apps
