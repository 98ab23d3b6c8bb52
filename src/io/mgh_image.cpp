// After FreeSurfer's wiki, "FsTutorial/MghFormat" (surfer.nmr.mgh.harvard.edu): a header of 284 bytes, big end first,
// then the voxels, then what is no concern of a label image.
#include "io/mgh_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "base/vec.h"
#include "io/label_image_frame.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/voxel_type.h"
#include "io/zip_file.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kHeaderBytes = 284;
using HeaderBytes = std::array<std::byte, kHeaderBytes>;

/// FreeSurfer's numbers for the types of voxels.
struct MghType {
  int code;
  NumberType type;
};

constexpr std::array<MghType, 5> kTypes = {
    {{0, NumberType::u8}, {1, NumberType::i32}, {3, NumberType::f32}, {4, NumberType::i16}, {10, NumberType::u16}}};

struct MghHeader {
  int version = 0;
  std::array<int, 3> size = {};
  int frames = 0;
  int type = 0;
  bool has_place = false;  ///< else the rest is to be taken as what FreeSurfer supposes
  Vec3 spacing_mm = {1, 1, 1};
  std::array<Vec3, 3> axes_ras = {{{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  Vec3 centre_ras;  ///< of the voxel (size / 2)
};

template <typename Number>
Number number_at(const HeaderBytes& bytes, std::size_t at) {
  std::array<std::byte, sizeof(Number)> raw;
  std::reverse_copy(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(Number)), raw.begin());
  return std::bit_cast<Number>(raw);
}

Vec3 vector_at(const HeaderBytes& bytes, std::size_t at) {
  const auto part = [&](std::size_t n) { return static_cast<double>(number_at<float>(bytes, at + 4 * n)); };
  return {part(0), part(1), part(2)};
}

MghHeader read_header(const fs::path& path) {
  HeaderBytes bytes = {};
  if (ZipFile(path).read(bytes.data(), kHeaderBytes) != kHeaderBytes) {
    throw IoError(in_quotes(path) + " is truncated or damaged: an MGH header takes " + number_text(kHeaderBytes) +
                  " bytes");
  }
  MghHeader h;
  h.version = number_at<std::int32_t>(bytes, 0);
  for (std::size_t axis = 0; axis < 3; ++axis) h.size[axis] = number_at<std::int32_t>(bytes, 4 + 4 * axis);
  h.frames = number_at<std::int32_t>(bytes, 16);
  h.type = number_at<std::int32_t>(bytes, 20);
  h.has_place = number_at<std::int16_t>(bytes, 28) > 0;
  if (!h.has_place) return h;
  h.spacing_mm = vector_at(bytes, 30);
  for (std::size_t axis = 0; axis < 3; ++axis) h.axes_ras[axis] = vector_at(bytes, 42 + 12 * axis);
  h.centre_ras = vector_at(bytes, 78);
  return h;
}

/// Throws unless the header is that of one 3D image.
void check_header(const fs::path& path, const MghHeader& h) {
  if (h.version != 1) {
    throw IoError(in_quotes(path) + " is damaged or no MGH file: its version is " + number_text(h.version) +
                  ", 1 is needed");
  }
  const std::string sizes = number_text(h.size[0]) + " x " + number_text(h.size[1]) + " x " + number_text(h.size[2]);
  if (std::ranges::min(h.size) < 1) {
    throw InvalidInput(in_quotes(path) + " has the size " + sizes + "; at least 1 is needed");
  }
  if (h.frames != 1) {
    throw InvalidInput(in_quotes(path) + " has " + number_text(h.frames) + " frames of " + sizes +
                       "; one 3D image is needed");
  }
}

NumberType voxel_type_of(const fs::path& path, const MghHeader& h) {
  const auto found = std::ranges::find(kTypes, h.type, &MghType::code);
  if (found != kTypes.end()) return found->type;
  throw InvalidInput(in_quotes(path) + " has voxels of MGH type " + number_text(h.type) +
                     "; one label a voxel is needed, an integer of 8 to 32 bits or a float that is a whole number");
}

/// RAS is LPS with two axes turned round.
Vec3 lps(Vec3 ras) { return {0.0 - ras.x, 0.0 - ras.y, ras.z}; }  // 0.0 -: no negative zeros

ImageGeometry geometry_of(const MghHeader& h) {
  ImageGeometry g;
  g.spacing_mm = h.spacing_mm;
  Vec3 origin_ras = h.centre_ras;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    origin_ras = origin_ras - (0.5 * h.size[axis] * h.spacing_mm[axis]) * h.axes_ras[axis];
    const Vec3 direction = lps(h.axes_ras[axis]);
    for (std::size_t row = 0; row < 3; ++row) g.direction[row][axis] = direction[row];
  }
  g.origin_mm = lps(origin_ras);
  return g;
}

}  // namespace

bool is_mgh_file(const fs::path& path) {
  constexpr std::array kExtensions = {".mgz", ".mgh", ".mgh.gz"};
  return std::ranges::find(kExtensions, file_extension(path)) != kExtensions.end();
}

ImageFile read_mgh_image(const fs::path& path) {
  const MghHeader header = read_header(path);
  check_header(path, header);
  const NumberType type = voxel_type_of(path, header);
  const auto along = [&](std::size_t axis) { return static_cast<std::size_t>(header.size[axis]); };
  const std::array<std::size_t, 3> size = {along(0), along(1), along(2)};
  require_room_in_file(path, path,
                       static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) *
                           static_cast<double>(bytes_of(type)));
  ImageFile result;
  if (!header.has_place) {
    result.notes.push_back(in_quotes(path) +
                           " does not say where it lies; it is taken as FreeSurfer does: coronal slices of 1 mm voxels "
                           "around the origin");
  }
  result.image = blank_image(path, size, geometry_of(header), bytes_of(type));
  const std::size_t count = result.image.voxels.size();
  std::vector<std::byte> values(count * bytes_of(type));
  read_voxels(path, path, kHeaderBytes, values.data(), values.size());
  if constexpr (std::endian::native == std::endian::little) swap_bytes(values.data(), count, bytes_of(type));
  store_voxels({path, size}, type, {}, values.data(), count, result.image.voxels.data());
  return result;
}

}  // namespace anatomesh
