// After the format's definition: nifti.nimh.nih.gov, nifti1.h.
#include "io/nifti_header.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "anatomesh/errors.h"
#include "base/rotation.h"
#include "base/vec.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/zip_file.h"

namespace anatomesh {
namespace {

constexpr std::size_t kHeaderBytes = 348;
constexpr std::size_t kNifti2HeaderBytes = 540;
using HeaderBytes = std::array<std::byte, kHeaderBytes>;

/// The two forms are said to disagree when they put a corner of the image further apart than this share
/// of the smallest spacing: well above the rounding of 32-bit floats, well below what matters to a mesh.
constexpr double kDisagreementVoxels = 0.01;

/// Header and voxels may be two files, and the user may name either.
std::filesystem::path header_file(std::filesystem::path path) {
  const std::string extension = file_extension(path);
  if (extension == ".img.gz") return path.replace_extension().replace_extension(".hdr.gz");
  if (extension == ".img") return path.replace_extension(".hdr");
  return path;
}

HeaderBytes read_bytes(const std::filesystem::path& path) {
  HeaderBytes bytes = {};
  if (ZipFile(path).read(bytes.data(), kHeaderBytes) != kHeaderBytes) {
    throw IoError(in_quotes(path) + " is truncated or damaged: a NIfTI header takes " + number_text(kHeaderBytes) +
                  " bytes");
  }
  return bytes;
}

/// Takes numbers out of the header's bytes, in the byte order of the file.
class Fields {
 public:
  Fields(std::span<const std::byte> bytes, bool swap) : bytes_(bytes), swap_(swap) {}

  int i16(std::size_t at) const { return take<std::int16_t>(at); }
  int i32(std::size_t at) const { return take<std::int32_t>(at); }
  double f32(std::size_t at) const { return static_cast<double>(take<float>(at)); }
  char character(std::size_t at) const { return static_cast<char>(bytes_[at]); }

 private:
  template <typename Number>
  Number take(std::size_t at) const {
    std::array<std::byte, sizeof(Number)> raw;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), raw.size(), raw.begin());
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  std::span<const std::byte> bytes_;
  bool swap_;
};

/// The size that a header gives itself, if it is one of a known kind; else 0.
std::size_t known_header_size(std::span<const std::byte> bytes, bool swap) {
  const auto size = static_cast<std::size_t>(Fields(bytes, swap).i32(0));
  return size == kHeaderBytes || size == kNifti2HeaderBytes ? size : 0;
}

NiftiHeader parse(const HeaderBytes& bytes, bool swap) {
  const Fields fields(bytes, swap);
  NiftiHeader h;
  for (std::size_t n = 0; n < 8; ++n) h.dim[n] = fields.i16(40 + 2 * n);
  for (std::size_t n = 0; n < 8; ++n) h.pixdim[n] = fields.f32(76 + 4 * n);
  h.datatype = fields.i16(70);
  h.vox_offset = fields.f32(108);
  h.scl_slope = fields.f32(112);
  h.scl_inter = fields.f32(116);
  h.xyzt_units = static_cast<unsigned char>(fields.character(123));
  h.qform_code = fields.i16(252);
  h.sform_code = fields.i16(254);
  for (std::size_t n = 0; n < 3; ++n) h.quatern[n] = fields.f32(256 + 4 * n);
  for (std::size_t n = 0; n < 3; ++n) h.qoffset[n] = fields.f32(268 + 4 * n);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t n = 0; n < 4; ++n) h.srow[row][n] = fields.f32(280 + 16 * row + 4 * n);
  }
  const std::string magic = {fields.character(344), fields.character(345), fields.character(346)};
  h.is_single_file = magic == "n+1";
  h.is_nifti = h.is_single_file || magic == "ni1";
  h.is_swapped = swap;
  return h;
}

/// Millimetres in the unit of length of xyzt_units; files without one are in mm by convention.
double unit_mm(int xyzt_units) {
  constexpr std::array<double, 8> kUnits = {1, 1000, 1, 0.001, 1, 1, 1, 1};  // unknown, m, mm, um
  return kUnits[static_cast<std::size_t>(xyzt_units & 7)];
}

/// NIfTI is RAS, LabelImage is LPS.
Vec3 lps(Vec3 ras) { return {0.0 - ras.x, 0.0 - ras.y, ras.z}; }  // 0.0 -: no negative zeros

/// Length of a column of 32-bit floats; a spacing that differs from it by rounding only is the better number.
double snapped_to(double spacing, double length) {
  constexpr double kFloatRounding = 1e-6;
  return std::abs(length - spacing) <= kFloatRounding * spacing ? spacing : length;
}

ImageGeometry geometry_from_sform(const NiftiHeader& h) {
  const double mm = unit_mm(h.xyzt_units);
  const auto column = [&](std::size_t c) { return lps({h.srow[0][c], h.srow[1][c], h.srow[2][c]}); };
  ImageGeometry g;
  g.origin_mm = mm * column(3);
  for (std::size_t c = 0; c < 3; ++c) {
    const double length = norm(column(c));
    g.spacing_mm[c] = mm * snapped_to(h.pixdim[c + 1], length);
    for (std::size_t r = 0; r < 3; ++r) g.direction[r][c] = column(c)[r] / length;
  }
  return g;
}

ImageGeometry geometry_from_qform(const NiftiHeader& h) {
  auto [b, c, d] = h.quatern;
  const double vector_part = b * b + c * c + d * d;
  double a = std::sqrt(std::max(0.0, 1 - vector_part));
  const double scale = 1 / std::sqrt(a * a + vector_part);  // not 1 where rounding left the sum above 1
  a *= scale, b *= scale, c *= scale, d *= scale;
  const double qfac = h.pixdim[0] < 0 ? -1 : 1;
  const Mat3 ras = {{{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c) * qfac},
                     {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b) * qfac},
                     {2 * (b * d - a * c), 2 * (c * d + a * b), (a * a + d * d - b * b - c * c) * qfac}}};
  const double mm = unit_mm(h.xyzt_units);
  ImageGeometry g;
  g.spacing_mm = mm * Vec3{h.pixdim[1], h.pixdim[2], h.pixdim[3]};
  g.origin_mm = mm * lps({h.qoffset[0], h.qoffset[1], h.qoffset[2]});
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3 axis = lps({ras[0][column], ras[1][column], ras[2][column]});
    for (std::size_t row = 0; row < 3; ++row) g.direction[row][column] = axis[row];
  }
  return g;
}

bool is_rotation(const ImageGeometry& g) { return deviation_from_orthonormal(g.direction) <= kDirectionTolerance; }

/// Largest distance, in mm, between the places that two geometries give to a corner of the image.
double largest_corner_distance(const NiftiHeader& h, const ImageGeometry& one, const ImageGeometry& other) {
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto end = [&](int axis) {
      return (corner >> axis & 1) != 0 ? h.dim[static_cast<std::size_t>(axis) + 1] - 1.0 : 0.0;
    };
    const Vec3 index = {end(0), end(1), end(2)};
    largest = std::max(largest, norm(physical_point(one, index) - physical_point(other, index)));
  }
  return largest;
}

std::string disagreement_note(const std::filesystem::path& path, double distance_mm) {
  return "qform and sform of " + in_quotes(path) + " disagree by up to " +
         number_text(std::round(distance_mm * 1000) / 1000) + " mm; the sform is used";
}

}  // namespace

std::array<std::size_t, 3> NiftiHeader::size() const {
  return {static_cast<std::size_t>(dim[1]), static_cast<std::size_t>(dim[2]), static_cast<std::size_t>(dim[3])};
}

bool is_nifti_file(const std::filesystem::path& path) {
  const std::filesystem::path file = header_file(path);
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return false;
  std::array<std::byte, 4> start = {};
  try {
    ZipFile(file).read(start.data(), start.size());
  } catch (const IoError&) {
    return false;
  }
  return known_header_size(start, false) != 0 || known_header_size(start, true) != 0;
}

NiftiHeader read_nifti_header(const std::filesystem::path& path) {
  const std::filesystem::path file = header_file(path);
  const HeaderBytes bytes = read_bytes(file);
  for (const bool swap : {false, true}) {
    const std::size_t size = known_header_size(std::span(bytes).first<4>(), swap);
    if (size == kHeaderBytes) return parse(bytes, swap);
    if (size == kNifti2HeaderBytes) throw InvalidInput(in_quotes(path) + " is a NIfTI-2 file; convert it to NIfTI-1");
  }
  throw InvalidInput(in_quotes(path) + " has no NIfTI header: it must start with the number 348");
}

NiftiGeometry nifti_geometry(const std::filesystem::path& path, const NiftiHeader& h) {
  const ImageGeometry sform = geometry_from_sform(h), qform = geometry_from_qform(h);
  NiftiGeometry result;
  if (unit_mm(h.xyzt_units) != 1) {
    result.notes.push_back(in_quotes(path) + " is given in units of " + number_text(unit_mm(h.xyzt_units)) +
                           " mm; it was converted to mm");
  }
  if (h.qform_code <= 0 && h.sform_code <= 0) {
    result.geometry.spacing_mm = qform.spacing_mm;
    result.notes.push_back(in_quotes(path) + " does not say where it lies (" +
                           (h.is_nifti ? "its qform and sform codes are 0" : "it is an Analyze file") +
                           "); its axes are taken as left, posterior, superior, its origin as 0");
  } else if (h.sform_code > 0 && (is_rotation(sform) || h.qform_code <= 0)) {
    result.geometry = sform;
    const double smallest = std::min({qform.spacing_mm.x, qform.spacing_mm.y, qform.spacing_mm.z});
    const double distance = largest_corner_distance(h, sform, qform);
    if (h.qform_code > 0 && !(distance <= kDisagreementVoxels * smallest)) {
      result.notes.push_back(disagreement_note(path, distance));
    }
  } else {
    result.geometry = qform;
    if (h.sform_code > 0) {
      result.notes.push_back("the sform of " + in_quotes(path) +
                             " is not a rotation times the voxel spacing; the qform is used");
    }
  }
  return result;
}

}  // namespace anatomesh
