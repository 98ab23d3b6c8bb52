#include "apps/output_paths.h"

#include "anatomesh/errors.h"
#include "anatomesh/io.h"

namespace anatomesh::apps {

void require_mesh_output(const std::filesystem::path& path) {
  try {
    check_mesh_writable(path);
  } catch (const InvalidInput& error) {
    throw InvalidOption(error.what());
  }
}

void require_text_output(const std::filesystem::path& path) {
  if (!path.empty()) check_writable(path);
}

}  // namespace anatomesh::apps
