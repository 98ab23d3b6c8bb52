#include "apps/output_paths.h"

#include "anatomesh/errors.h"
#include "anatomesh/io.h"

namespace anatomesh::apps {

namespace {

/// What is wrong with the path is wrong with an option.
void require(void (*check)(const std::filesystem::path&), const std::filesystem::path& path) {
  try {
    check(path);
  } catch (const InvalidInput& error) {
    throw InvalidOption(error.what());
  }
}

}  // namespace

void require_mesh_output(const std::filesystem::path& path) { require(&check_mesh_writable, path); }
void require_surface_output(const std::filesystem::path& path) { require(&check_tissue_surfaces_writable, path); }

void require_text_output(const std::filesystem::path& path) {
  if (!path.empty()) check_writable(path);
}

void require_different_files(const std::vector<std::filesystem::path>& paths) {
  namespace fs = std::filesystem;
  std::error_code none;
  for (std::size_t a = 0; a < paths.size(); ++a) {
    for (std::size_t b = a + 1; b < paths.size(); ++b) {
      if (paths[a].empty() || paths[b].empty()) continue;
      const bool same = fs::weakly_canonical(paths[a], none) == fs::weakly_canonical(paths[b], none) ||
                        (fs::is_regular_file(paths[a], none) && fs::equivalent(paths[a], paths[b], none));
      if (!same) continue;
      throw InvalidOption("'" + paths[a].string() + "' and '" + paths[b].string() +
                          "' are the same file; an output needs a file of its own");
    }
  }
}

std::uintmax_t size_on_disk(const std::filesystem::path& path) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  return none ? 0 : size;
}

}  // namespace anatomesh::apps
