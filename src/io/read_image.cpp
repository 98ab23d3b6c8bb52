#include <itkGDCMImageIO.h>
#include <itkMetaDataObject.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "base/vec.h"
#include "io/dicom_segmentation.h"
#include "io/file_checks.h"
#include "io/image_geometry.h"
#include "io/itk_session.h"
#include "io/label_image_frame.h"
#include "io/mgh_image.h"
#include "io/muted_stderr.h"
#include "io/nifti_header.h"
#include "io/nifti_image.h"
#include "io/output_file.h"
#include "io/reader_process.h"
#include "io/slicer_segments.h"
#include "io/voxel_type.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// ITK's names for the types of voxels.
struct Component {
  itk::IOComponentEnum component;
  NumberType type;
};

static_assert(sizeof(long) == 8 && sizeof(long long) == 8);

constexpr std::array<Component, 12> kComponents = {{{itk::IOComponentEnum::UCHAR, NumberType::u8},
                                                    {itk::IOComponentEnum::CHAR, NumberType::i8},
                                                    {itk::IOComponentEnum::USHORT, NumberType::u16},
                                                    {itk::IOComponentEnum::SHORT, NumberType::i16},
                                                    {itk::IOComponentEnum::UINT, NumberType::u32},
                                                    {itk::IOComponentEnum::INT, NumberType::i32},
                                                    {itk::IOComponentEnum::ULONG, NumberType::u64},
                                                    {itk::IOComponentEnum::LONG, NumberType::i64},
                                                    {itk::IOComponentEnum::ULONGLONG, NumberType::u64},
                                                    {itk::IOComponentEnum::LONGLONG, NumberType::i64},
                                                    {itk::IOComponentEnum::FLOAT, NumberType::f32},
                                                    {itk::IOComponentEnum::DOUBLE, NumberType::f64}}};

void require_one_number_a_voxel(const fs::path& path, const itk::ImageIOBase& io) {
  if (io.GetNumberOfComponents() != 1 || io.GetPixelType() != itk::IOPixelEnum::SCALAR) {
    throw InvalidInput(in_quotes(path) + " has " + number_text(io.GetNumberOfComponents()) + " numbers a voxel (" +
                       itk::ImageIOBase::GetPixelTypeAsString(io.GetPixelType()) + "); one label a voxel is needed");
  }
}

NumberType voxel_type_of(const fs::path& path, const itk::ImageIOBase& io) {
  const auto found = std::find_if(kComponents.begin(), kComponents.end(),
                                  [&](const Component& c) { return c.component == io.GetComponentType(); });
  if (found != kComponents.end()) return found->type;
  throw InvalidInput(in_quotes(path) + " has voxels of type " +
                     itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType()) +
                     "; one label a voxel is needed, an integer of 8 to 64 bits or a float that is a whole number");
}

std::string size_text(const itk::ImageIOBase& io) {
  std::string text;
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) {
    text += (axis == 0 ? "" : " x ") + number_text(io.GetDimensions(axis));
  }
  return text;
}

/// The size of a 3D image; throws for any other, and for one without voxels.
std::array<std::size_t, 3> size_of(const fs::path& path, const itk::ImageIOBase& io) {
  const unsigned dimensions = io.GetNumberOfDimensions();
  const bool is_3d = dimensions >= 3 && [&] {
    for (unsigned axis = 3; axis < dimensions; ++axis) {
      if (io.GetDimensions(axis) != 1) return false;
    }
    return true;
  }();
  if (!is_3d) {
    throw InvalidInput(in_quotes(path) + " is a " + number_text(dimensions) + "D image (" + size_text(io) +
                       "); one 3D image is needed");
  }
  const std::array<std::size_t, 3> size = {io.GetDimensions(0), io.GetDimensions(1), io.GetDimensions(2)};
  if (size[0] == 0 || size[1] == 0 || size[2] == 0) {
    throw InvalidInput(in_quotes(path) + " has the size " + size_text(io) + "; at least one voxel is needed");
  }
  return size;
}

ImageGeometry geometry_of(const itk::ImageIOBase& io) {
  ImageGeometry g;
  for (unsigned axis = 0; axis < 3; ++axis) {
    g.spacing_mm[axis] = io.GetSpacing(axis);
    g.origin_mm[axis] = io.GetOrigin(axis);
    const std::vector<double> direction = io.GetDirection(axis);
    for (unsigned row = 0; row < 3; ++row) g.direction[row][axis] = direction[row];
  }
  return g;
}

/// Runs a call into ITK; its exceptions become an IoError that names the file.
template <typename Call>
void call_itk(const fs::path& path, const char* what_failed, Call&& call) {
  const std::string sentence_start = in_quotes(path) + " is truncated or damaged: " + what_failed;
  try {
    call();
  } catch (const itk::ExceptionObject& error) {
    throw IoError(sentence_start + " (" + description(error) + ")");
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw IoError(sentence_start + " (" + error.what() + ")");
  }
}

void read_header(const fs::path& path, itk::ImageIOBase& io) {
  io.SetFileName(path.string());
  call_itk(path, "its header cannot be read", [&] { io.ReadImageInformation(); });
}

/// A DICOM segmentation object holds a stack of masks for each tissue, which would pass for slices.
void refuse_segmentation_object(const fs::path& path, const itk::ImageIOBase& io) {
  std::string modality;
  itk::ExposeMetaData<std::string>(io.GetMetaDataDictionary(), "0008|0060", modality);
  if (modality.substr(0, 3) != "SEG") return;
  throw InvalidInput(in_quotes(path) +
                     " is a DICOM segmentation object; name a binary one itself, not its folder, or "
                     "convert it to a label image, e.g. in NIfTI");
}

/// Reads all values of the file that io has the header of.
void read_values(const fs::path& path, itk::ImageIOBase& io, void* values) {
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned axis = 0; axis < io.GetNumberOfDimensions(); ++axis) region.SetSize(axis, io.GetDimensions(axis));
  io.SetIORegion(region);
  call_itk(path, "its voxels cannot be read", [&] { io.Read(values); });
}

/// Reads all voxels of the file that io has the header of. place says where they belong.
void read_voxels(const VoxelPlace& place, itk::ImageIOBase& io, Label* labels) {
  const NumberType type = voxel_type_of(place.path, io);
  require_one_number_a_voxel(place.path, io);
  const auto count = static_cast<std::size_t>(io.GetImageSizeInPixels());
  std::vector<std::byte> buffer(bytes_of(type) == sizeof(Label) ? 0 : count * bytes_of(type));
  void* const values = buffer.empty() ? static_cast<void*>(labels) : buffer.data();
  read_values(place.path, io, values);
  store_voxels(place, type, {}, values, count, labels);
}

/// The keys of a NRRD file, among others.
std::map<std::string, std::string> keys_of(const itk::ImageIOBase& io) {
  std::map<std::string, std::string> keys;
  const itk::MetaDataDictionary& dictionary = io.GetMetaDataDictionary();
  for (const std::string& key : dictionary.GetKeys()) {
    std::string text;
    if (itk::ExposeMetaData<std::string>(dictionary, key, text)) keys[key] = text;
  }
  return keys;
}

/// Reads the layers of a segmentation into one image, a piece at a time. Returns what to tell the user.
std::vector<std::string> read_layers(const fs::path& path, const std::vector<Segment>& segments, itk::ImageIOBase& io,
                                     LabelImage& image) {
  constexpr std::size_t kVoxelsAtOnce = std::size_t{1} << 14;
  const NumberType type = voxel_type_of(path, io);
  const std::size_t layers = io.GetNumberOfComponents(), count = image.voxels.size();
  std::vector<std::byte> values(count * layers * bytes_of(type));
  read_values(path, io, values.data());
  LayerMerger merger(segments, layers);
  std::vector<Label> piece(std::min(count, kVoxelsAtOnce) * layers);
  for (std::size_t first = 0; first < count; first += kVoxelsAtOnce) {
    const std::size_t voxels = std::min(kVoxelsAtOnce, count - first);
    const std::byte* const from = values.data() + first * layers * bytes_of(type);
    if (const auto bad = store_labels(type, from, voxels * layers, piece.data())) {
      throw InvalidInput("layer " + number_text(bad->position % layers) + " of " + in_quotes(path) + " has the value " +
                         bad->value + "; " + kLabelRule);
    }
    merger.merge(piece.data(), voxels, image.voxels.data() + first);
  }
  return merger.notes(path);
}

/// A compressed file cannot hold more than 1032 times its size (zlib), an uncompressed one no more than
/// its size: a header that declares more is not worth reserving memory for.
void require_plausible_size(const fs::path& path, const itk::ImageIOBase& io) {
  constexpr double kMostCompression = 1032;
  const double declared = static_cast<double>(io.GetImageSizeInBytes());
  const double present = static_cast<double>(fs::file_size(path));
  const bool has_detached_voxels = [&] {
    constexpr std::array kDetached = {".hdr", ".hdr.gz", ".mhd", ".nhdr"};
    return std::find(kDetached.begin(), kDetached.end(), file_extension(path)) != kDetached.end();
  }();
  if (has_detached_voxels || declared <= kMostCompression * present) return;
  throw IoError(in_quotes(path) + " is truncated or damaged: its " + number_text(present) +
                " bytes cannot hold the voxels of " + size_text(io));
}

itk::ImageIOBase::Pointer format_of(const fs::path& path) {
  for (const auto& format : image_formats()) {
    if (format->CanReadFile(path.c_str())) return format;
  }
  constexpr std::array kOwn = {".nii",  ".nii.gz", ".hdr", ".img", ".img.gz", ".nrrd",
                               ".nhdr", ".mha",    ".mhd", ".mnc", ".dcm"};
  if (std::find(kOwn.begin(), kOwn.end(), file_extension(path)) != kOwn.end()) {
    throw IoError(in_quotes(path) + " is truncated, damaged or not in the format of its extension");
  }
  throw InvalidInput(in_quotes(path) +
                     " is not an image in a known format; NIfTI, Analyze, NRRD, MetaImage, MINC, MGH and a folder "
                     "with a DICOM series can be read");
}

/// Reads the voxels of a file that io has the header of.
ImageFile read_image_or_layers(const fs::path& path, std::array<std::size_t, 3> size, itk::ImageIOBase& io) {
  const NumberType type = voxel_type_of(path, io);
  const std::size_t layers = io.GetNumberOfComponents();
  const SegmentList list = segments_of(path, keys_of(io), layers);
  const bool is_layered = !list.segments.empty() && io.GetPixelType() != itk::IOPixelEnum::SCALAR;
  if (!is_layered) require_one_number_a_voxel(path, io);
  require_plausible_size(path, io);
  ImageFile file;
  file.image = blank_image(path, size, geometry_of(io), layers * bytes_of(type));
  file.image.names = list.names();
  file.notes = list.notes;
  if (is_layered) {
    const std::vector<std::string> notes = read_layers(path, list.segments, io, file.image);
    file.notes.insert(file.notes.end(), notes.begin(), notes.end());
  } else {
    read_voxels({path, size}, io, file.image.voxels.data());
  }
  return file;
}

ImageFile read_single_file(const fs::path& path, const ItkSession& itk_session) {
  check_before_itk(path);
  std::optional<MutedStderr> muted;
  if (is_read_by_printing_library(path)) muted.emplace();
  const itk::ImageIOBase::Pointer io = format_of(path);
  read_header(path, *io);
  refuse_segmentation_object(path, *io);
  const std::array<std::size_t, 3> size = size_of(path, *io);
  if (dynamic_cast<itk::GDCMImageIO*>(io.GetPointer()) != nullptr) {
    if (size[2] == 1) {
      throw InvalidInput(in_quotes(path) + " is one slice of a DICOM series; give the folder with all its slices");
    }
    check_dicom_pixels(path, size[0] * size[1] * size[2]);
  }
  ImageFile file = read_image_or_layers(path, size, *io);
  for (const std::string& warning : itk_session.warnings()) file.notes.push_back(in_quotes(path) + ": " + warning);
  return file;
}

/// One file of a DICOM series.
struct Slice {
  std::string file;
  itk::ImageIOBase::Pointer io;
  ImageGeometry geometry;
};

/// Whether a file begins as DICOM files do. GDCM aborts on some files that do not.
bool has_dicom_preamble(const fs::path& path) {
  constexpr std::streamoff kPreamble = 128;
  std::array<char, 4> magic{};
  std::ifstream stream(path, std::ios::binary);
  stream.seekg(kPreamble);
  stream.read(magic.data(), magic.size());
  return stream.gcount() == 4 && std::string_view(magic.data(), magic.size()) == "DICM";
}

/// The DICOM images in a folder by the series that they belong to. Files of other kinds are passed over.
std::map<std::string, std::vector<Slice>> slices_by_series(const fs::path& folder) {
  std::map<std::string, std::vector<Slice>> series;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (!entry.is_regular_file() || file.filename() == "DICOMDIR" || !has_dicom_preamble(file)) continue;
    Slice slice{file.string(), itk::GDCMImageIO::New().GetPointer(), {}};
    read_header(file, *slice.io);
    refuse_segmentation_object(file, *slice.io);
    slice.geometry = geometry_of(*slice.io);
    std::string uid;
    itk::ExposeMetaData<std::string>(slice.io->GetMetaDataDictionary(), "0020|000e", uid);
    series[uid.c_str()].push_back(std::move(slice));  // c_str: DICOM pads with a zero byte
  }
  return series;
}

/// The slices of the only series in a folder, in the order of their positions.
std::vector<Slice> only_series(const fs::path& folder) {
  auto series = slices_by_series(folder);
  if (series.empty()) throw InvalidInput("the folder " + in_quotes(folder) + " holds no DICOM series");
  if (series.size() > 1) {
    std::string list;
    for (const auto& [uid, slices] : series) list += "\n  " + uid + " (" + number_text(slices.size()) + " files)";
    throw InvalidInput("the folder " + in_quotes(folder) + " holds " + number_text(series.size()) +
                       " DICOM series; leave one of them in a folder of its own:" + list);
  }
  std::vector<Slice>& slices = series.begin()->second;
  const Mat3& d = slices.front().geometry.direction;
  const Vec3 normal = cross({d[0][0], d[1][0], d[2][0]}, {d[0][1], d[1][1], d[2][1]});
  std::sort(slices.begin(), slices.end(), [&](const Slice& one, const Slice& other) {
    const double position = dot(normal, one.geometry.origin_mm), next = dot(normal, other.geometry.origin_mm);
    return position != next ? position < next : one.file < other.file;
  });
  return std::move(slices);
}

/// The geometry of a stack of slices from those of its single slices, which must be equally spaced.
ImageGeometry stack_geometry(const fs::path& folder, const std::vector<Slice>& slices) {
  ImageGeometry stack = slices.front().geometry;
  if (slices.size() == 1) return stack;
  const double last = static_cast<double>(slices.size() - 1);
  const Vec3 step = (1 / last) * (slices.back().geometry.origin_mm - stack.origin_mm);
  stack.spacing_mm.z = norm(step);
  for (std::size_t row = 0; row < 3; ++row) stack.direction[row][2] = step[row] / stack.spacing_mm.z;
  constexpr double kUnevenness = 0.01;  // of the spacing; scanners round positions to some digits
  for (std::size_t n = 0; n < slices.size(); ++n) {
    const Vec3 expected = stack.origin_mm + static_cast<double>(n) * step;
    const double off = norm(slices[n].geometry.origin_mm - expected);
    if (off <= kUnevenness * stack.spacing_mm.z) continue;
    throw InvalidInput("slice " + number_text(n + 1) + " of the DICOM series in " + in_quotes(folder) + " is " +
                       number_text(off) + " mm off an even spacing of " + number_text(stack.spacing_mm.z) +
                       " mm; a slice may be missing");
  }
  return stack;
}

/// Voxels of the whole stack. Throws unless all slices are of one layer of the same size.
std::array<std::size_t, 3> stack_size(const fs::path& folder, const std::vector<Slice>& slices) {
  std::array<std::size_t, 3> size = size_of(slices.front().file, *slices.front().io);
  if (slices.size() == 1) {
    if (size[2] > 1) return size;
    throw InvalidInput("the DICOM series in " + in_quotes(folder) + " has a single slice; a 3D image is needed");
  }
  for (const Slice& slice : slices) {
    if (size_of(slice.file, *slice.io) == std::array<std::size_t, 3>{size[0], size[1], 1}) continue;
    throw InvalidInput(in_quotes(slice.file) + " is a slice of " + size_text(*slice.io) +
                       " in a series that begins with one of " + size_text(*slices.front().io) +
                       "; all must be alike, with one layer each");
  }
  size[2] = slices.size();
  return size;
}

ImageFile read_dicom_series(const fs::path& folder) {
  const std::vector<Slice> slices = only_series(folder);
  const std::array<std::size_t, 3> size = stack_size(folder, slices);
  const std::size_t slice_voxels = size[0] * size[1] * size[2] / slices.size();
  ImageFile file;
  file.image = blank_image(folder, size, stack_geometry(folder, slices), 0);  // the slices come one by one
  for (std::size_t n = 0; n < slices.size(); ++n) {
    check_dicom_pixels(slices[n].file, slice_voxels);
    read_voxels({slices[n].file, size, n * slice_voxels}, *slices[n].io, file.image.voxels.data() + n * slice_voxels);
  }
  return file;
}

/// An image without its voxels and names.
struct Frame {
  std::array<std::size_t, 3> size;
  ImageGeometry geometry;
  std::size_t notes;
};

void send(const ImageFile& file, ProcessChannel& parent) {
  const LabelImage& image = file.image;
  parent.put_one(Frame{image.size, {image.spacing_mm, image.origin_mm, image.direction}, file.notes.size()});
  for (const std::string& note : file.notes) parent.put(note);
  parent.put(image.voxels);
}

ImageFile receive(ProcessChannel& child) {
  const auto frame = child.get_one<Frame>();
  const auto& [spacing_mm, origin_mm, direction] = frame.geometry;
  ImageFile file;
  for (std::size_t n = 0; n < frame.notes; ++n) file.notes.push_back(child.get_text());
  const std::size_t voxels = frame.size[0] * frame.size[1] * frame.size[2];
  file.image = {frame.size, spacing_mm, origin_mm, direction, child.get_list<Label>(voxels)};
  return file;
}

ImageFile read_through_itk(const fs::path& path, const ItkSession& itk_session) {
  return fs::is_directory(path) ? read_dicom_series(path) : read_single_file(path, itk_session);
}

/// The same for files that have no names of labels.
ImageFile read_in_another_process(const fs::path& path, const ItkSession& itk_session) {
  const auto work = [&](ProcessChannel& parent) { send(read_through_itk(path, itk_session), parent); };
  return receive(ReaderProcess(path, work).child());
}

}  // namespace

ImageFile read_label_image(const fs::path& path) {
  require_readable(path);
  if (fs::is_regular_file(path) && is_mgh_file(path)) return read_mgh_image(path);
  if (fs::is_regular_file(path) && is_nifti_file(path)) return read_nifti_image(path);
  if (fs::is_regular_file(path) && is_dicom_segmentation(path)) return read_dicom_segmentation(path);
  const ItkSession itk_session;
  return is_read_by_crashing_library(path) ? read_in_another_process(path, itk_session)
                                           : read_through_itk(path, itk_session);
}

}  // namespace anatomesh
