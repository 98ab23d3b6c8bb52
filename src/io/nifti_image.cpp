#include "io/nifti_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "io/label_image_frame.h"
#include "io/nifti_header.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/voxel_type.h"
#include "io/zip_file.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// NIfTI's numbers for the types of voxels.
struct Datatype {
  int code;
  NumberType type;
};

constexpr std::array<Datatype, 10> kDatatypes = {{{2, NumberType::u8},
                                                  {256, NumberType::i8},
                                                  {512, NumberType::u16},
                                                  {4, NumberType::i16},
                                                  {768, NumberType::u32},
                                                  {8, NumberType::i32},
                                                  {1280, NumberType::u64},
                                                  {1024, NumberType::i64},
                                                  {16, NumberType::f32},
                                                  {64, NumberType::f64}}};

NumberType voxel_type_of(const fs::path& path, const NiftiHeader& h) {
  const auto found = std::find_if(kDatatypes.begin(), kDatatypes.end(),
                                  [&](const Datatype& datatype) { return datatype.code == h.datatype; });
  if (found != kDatatypes.end()) return found->type;
  throw InvalidInput(in_quotes(path) + " has voxels of NIfTI datatype " + number_text(h.datatype) +
                     "; one label a voxel is needed, an integer of 8 to 64 bits or a float that is a whole number");
}

/// Throws unless the file declares one 3D image, that is, further dimensions are 1.
void check_dimensions(const fs::path& path, const NiftiHeader& h) {
  const int count = h.dim[0];
  if (count < 1 || count > 7) {
    throw IoError(in_quotes(path) + " is damaged: it declares " + number_text(count) + " dimensions, 3 are needed");
  }
  std::string sizes;
  bool is_3d = count >= 3;
  for (int n = 1; n <= count; ++n) {
    const int size = h.dim[static_cast<std::size_t>(n)];
    sizes += (n == 1 ? "" : " x ") + number_text(size);
    if (n > 3 && size > 1) is_3d = false;
    if (n <= 3 && size < 1) throw InvalidInput(in_quotes(path) + " has the size " + sizes + "; at least 1 is needed");
  }
  if (is_3d) return;
  throw InvalidInput(in_quotes(path) + " is a " + number_text(count) + "D image (" + sizes +
                     "); one 3D image is needed");
}

void check_spacing(const fs::path& path, const NiftiHeader& h) {
  for (std::size_t axis = 1; axis <= 3; ++axis) {
    if (std::isfinite(h.pixdim[axis]) && h.pixdim[axis] > 0) continue;
    throw InvalidInput(in_quotes(path) + " has the voxel spacing " + number_text(h.pixdim[axis]) + " in pixdim[" +
                       number_text(axis) + "]; it must be above 0");
  }
}

/// The values of Analyze files are not scaled; a slope of 0 means none either. Large integers are computed with
/// as doubles, which hold them exactly.
ValueScale scale_of(const NiftiHeader& h) {
  if (!h.is_nifti || h.scl_slope == 0 || !std::isfinite(h.scl_slope) || !std::isfinite(h.scl_inter)) return {};
  return {h.scl_slope, h.scl_inter};
}

/// The file with the voxels of a header in a file of its own.
fs::path voxel_file(const fs::path& path) {
  fs::path stem = path;
  if (file_extension(path).ends_with(".gz")) stem.replace_extension();
  for (const char* extension : {".img", ".img.gz"}) {
    fs::path candidate = stem;
    candidate.replace_extension(extension);
    if (fs::exists(candidate)) return candidate;
  }
  throw IoError("the voxels of " + in_quotes(path) + " are missing: there is no " +
                in_quotes(stem.replace_extension(".img")) + " beside it");
}

/// Where the voxels begin. In a single file that is after the header and four bytes of flags.
std::size_t voxel_offset(const fs::path& path, const NiftiHeader& h) {
  constexpr double kLeastInSingleFile = 352;
  constexpr double kMost = 1e15;
  const double least = h.is_single_file ? kLeastInSingleFile : 0;
  if (!(h.vox_offset <= kMost)) {
    throw IoError(in_quotes(path) + " is damaged: its voxels are said to begin at byte " + number_text(h.vox_offset));
  }
  return static_cast<std::size_t>(std::max(h.vox_offset, least));
}

}  // namespace

ImageFile read_nifti_image(const fs::path& path) {
  const NiftiHeader header = read_nifti_header(path);
  check_dimensions(path, header);
  check_spacing(path, header);
  const NumberType type = voxel_type_of(path, header);
  NiftiGeometry geometry = nifti_geometry(path, header);

  const fs::path file = header.is_single_file ? path : voxel_file(path);
  const std::array<std::size_t, 3> size = header.size();
  const std::size_t count = size[0] * size[1] * size[2], bytes = count * bytes_of(type);
  require_room_in_file(path, file, static_cast<double>(bytes));

  const bool in_place = bytes_of(type) == sizeof(Label);
  ImageFile result;
  result.notes = std::move(geometry.notes);
  result.image = blank_image(path, size, geometry.geometry, in_place ? 0 : bytes_of(type));
  Label* const labels = result.image.voxels.data();
  std::vector<std::byte> buffer(in_place ? 0 : bytes);
  std::byte* const values = in_place ? reinterpret_cast<std::byte*>(labels) : buffer.data();
  read_voxels(path, file, voxel_offset(path, header), values, bytes);
  if (header.is_swapped) swap_bytes(values, count, bytes_of(type));
  store_voxels({path, size}, type, scale_of(header), values, count, labels);
  return result;
}

}  // namespace anatomesh
