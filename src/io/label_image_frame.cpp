#include "io/label_image_frame.h"

#include <cmath>
#include <string>

#include "anatomesh/errors.h"
#include "base/memory.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

void require_memory_for(const std::filesystem::path& path, double bytes) {
  constexpr double kGib = 1024.0 * 1024.0 * 1024.0;
  const double needed_gib = bytes / kGib;
  const double free_gib = available_memory_gib();
  if (free_gib <= 0 || needed_gib <= free_gib) return;
  const auto text = [](double gib) { return number_text(std::ceil(gib * 10) / 10) + " GiB"; };
  throw InvalidInput("reading " + in_quotes(path) + " needs " + text(needed_gib) + " of memory but only " +
                     text(free_gib) + " are free; crop or resample it, or use a larger machine");
}

}  // namespace

LabelImage blank_image(const std::filesystem::path& path, std::array<std::size_t, 3> size,
                       const ImageGeometry& geometry, std::size_t value_bytes) {
  const ImageGeometry checked = checked_geometry(path, geometry);
  const double voxels = static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]);
  require_memory_for(path, voxels * static_cast<double>(sizeof(Label) + value_bytes));
  LabelImage image;
  image.size = size;
  image.spacing_mm = checked.spacing_mm;
  image.origin_mm = checked.origin_mm;
  image.direction = checked.direction;
  image.voxels.resize(size[0] * size[1] * size[2]);
  return image;
}

}  // namespace anatomesh
