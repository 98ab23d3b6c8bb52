// The table at the end of `mesh`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "anatomesh/assess.h"
#include "anatomesh/image_to_mesh.h"

namespace anatomesh::apps {

/// What `mesh` has to show for a run.
struct MeshSummary {
  std::vector<std::filesystem::path> image_files;
  std::filesystem::path mesh_file;
  std::uint64_t mesh_bytes = 0;
  const Result* result = nullptr;
  ShapeSummary shapes;
  std::vector<StageTime> times;  ///< of reading, meshing, measuring and writing
};

/// The dozen lines at the end of `mesh`.
std::string mesh_table(const MeshSummary& summary);

}  // namespace anatomesh::apps
