#include "support/shared_data.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

fs::path shared_folder() {
  if (const char* named = std::getenv("ANATOMESH_SHARED_DATA")) return named;
  return fs::path(ANATOMESH_SOURCE_DIR) / ".." / "shared" / "data";
}

bool is_image(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.ends_with(".nii.gz") || name.ends_with(".nrrd");
}

}  // namespace

std::vector<fs::path> shared_images() {
  std::vector<fs::path> images;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(shared_folder(), missing))
    if (is_image(entry.path())) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  return images;
}

std::vector<fs::path> mricron_images() {
  constexpr std::array names = {"aal",
                                "brodmann",
                                "HarvardOxford-cort-maxprob-thr0-1mm",
                                "JHU-WhiteMatter-labels-1mm",
                                "JHU-WhiteMatter-labels-2mm",
                                "natbrainlab",
                                "jhu189",
                                "inia19-NeuroMaps",
                                "AICHAmc"};
  std::vector<fs::path> images;
  for (const char* name : names) {
    const fs::path path = fs::path("/usr/share/mricron/templates") / (std::string(name) + ".nii.gz");
    if (fs::exists(path)) images.push_back(path);
  }
  return images;
}

fs::path find_image(const fs::path& file_name) {
  for (const auto& images : {shared_images(), mricron_images()})
    for (const fs::path& path : images)
      if (path.filename() == file_name) return path;
  return {};
}

}  // namespace anatomesh::testing
