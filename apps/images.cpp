#include "apps/images.h"

#include <fmt/core.h>

namespace anatomesh::apps {

ImageFile read_images(const std::vector<std::filesystem::path>& paths) {
  return paths.size() == 1 ? read_label_image(paths.front()) : read_label_masks(paths);
}

std::string quoted(const std::vector<std::filesystem::path>& paths) {
  std::string text;
  for (const auto& path : paths) text += fmt::format("{}'{}'", text.empty() ? "" : ", ", path.string());
  return text;
}

}  // namespace anatomesh::apps
