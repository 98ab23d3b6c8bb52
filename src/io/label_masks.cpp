#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "base/vec.h"
#include "io/image_geometry.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/utf8.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// Grids agree that put no corner of the image further apart than this share of the smallest spacing: well above what
/// formats round, well below what matters to a mesh.
constexpr double kAgreementVoxels = 0.01;

ImageGeometry geometry_of(const LabelImage& image) { return {image.spacing_mm, image.origin_mm, image.direction}; }

std::string text_of(const std::array<std::size_t, 3>& size) {
  return number_text(size[0]) + " x " + number_text(size[1]) + " x " + number_text(size[2]);
}

std::string text_of(Vec3 v) { return number_text(v.x) + ", " + number_text(v.y) + ", " + number_text(v.z); }

/// Largest distance, in mm, between the places that two images of one size give to a corner.
double largest_corner_distance(const LabelImage& one, const LabelImage& other) {
  double largest = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto end = [&](unsigned axis) {
      return (corner >> axis & 1U) != 0 ? static_cast<double>(one.size[axis] - 1) : 0.0;
    };
    const Vec3 index = {end(0), end(1), end(2)};
    const Vec3 apart = physical_point(geometry_of(one), index) - physical_point(geometry_of(other), index);
    largest = std::max(largest, norm(apart));
  }
  return largest;
}

/// The mask and the first one, for messages about both.
struct Pair {
  const fs::path& first_path;
  const LabelImage& first;
  const fs::path& path;
  const LabelImage& mask;

  /// Throws InvalidInput.
  [[noreturn]] void fail(const std::string& of_first, const std::string& of_mask) const {
    throw InvalidInput(in_quotes(first_path) + " has the " + of_first + " and " + in_quotes(path) + " has the " +
                       of_mask + "; masks must have one grid, so resample one of them to the other's");
  }
};

/// Throws InvalidInput unless both have the same grid.
void require_same_grid(const Pair& pair) {
  const LabelImage &a = pair.first, &b = pair.mask;
  if (a.size != b.size) pair.fail("size " + text_of(a.size), "size " + text_of(b.size));
  const double allowed = kAgreementVoxels * std::min({a.spacing_mm.x, a.spacing_mm.y, a.spacing_mm.z});
  const double apart = largest_corner_distance(a, b);
  if (apart <= allowed) return;
  if (norm(a.spacing_mm - b.spacing_mm) > 1e-6 * norm(a.spacing_mm)) {
    pair.fail("spacing " + text_of(a.spacing_mm), "spacing " + text_of(b.spacing_mm));
  }
  if (norm(a.origin_mm - b.origin_mm) > allowed) {
    pair.fail("origin " + text_of(a.origin_mm), "origin " + text_of(b.origin_mm));
  }
  throw InvalidInput(in_quotes(pair.first_path) + " and " + in_quotes(pair.path) +
                     " have directions that put a corner " + number_text(apart) +
                     " mm apart; masks must have one grid, so resample one of them to the other's");
}

/// The only value but 0 that a mask has; 0 where there is none. Throws InvalidInput where there are several.
Label value_of(const fs::path& path, const LabelImage& mask) {
  Label value = 0;
  for (const Label voxel : mask.voxels) {
    if (voxel == 0 || voxel == value) continue;
    if (value != 0) {
      throw InvalidInput(in_quotes(path) + " has the values " + number_text(value) + " and " + number_text(voxel) +
                         "; where several images are given each must be a mask, with one value beside 0");
    }
    value = voxel;
  }
  return value;
}

/// The file's name without its extension; a folder's as it is.
std::string name_of(const fs::path& path) {
  const fs::path bare = path.has_filename() ? path : path.parent_path();
  std::string name = bare.filename().string();
  if (!fs::is_directory(bare)) {
    constexpr std::string_view kSegmentation = ".seg";  // of ".seg.nrrd"
    name.resize(name.size() - file_extension(name).size());
    if (file_extension(name) == kSegmentation) name.resize(name.size() - kSegmentation.size());
  }
  return is_one_line_of_utf8(name) ? name : std::string();
}

/// Gives the voxels of a mask the label. Returns how many had one already.
std::uint64_t put_label(const LabelImage& mask, Label label, LabelImage& image) {
  std::uint64_t taken = 0;
  for (std::size_t n = 0; n < mask.voxels.size(); ++n) {
    if (mask.voxels[n] == 0) continue;
    taken += image.voxels[n] != 0 ? 1 : 0;
    image.voxels[n] = label;
  }
  return taken;
}

}  // namespace

ImageFile read_label_masks(const std::vector<fs::path>& paths) {
  if (paths.empty()) throw InvalidInput("no mask is given; at least one is needed");
  ImageFile all;
  std::uint64_t overlaps = 0;
  for (std::size_t n = 0; n < paths.size(); ++n) {
    const auto label = static_cast<Label>(n + 1);
    ImageFile mask = read_label_image(paths[n]);
    all.notes.insert(all.notes.end(), mask.notes.begin(), mask.notes.end());
    if (value_of(paths[n], mask.image) == 0) {
      all.notes.push_back(in_quotes(paths[n]) + " has no voxel but 0; nothing is labelled " + number_text(label));
    }
    if (n == 0) {
      all.image = mask.image;
      std::ranges::fill(all.image.voxels, Label{0});
      all.image.names.clear();
    }
    require_same_grid({paths[0], all.image, paths[n], mask.image});
    overlaps += put_label(mask.image, label, all.image);
    all.image.names[label].name = name_of(paths[n]);
  }
  if (overlaps > 0) {
    all.notes.push_back(number_text(overlaps) +
                        " voxels of a mask lie in an earlier one, too; the later mask has them");
  }
  return all;
}

}  // namespace anatomesh
