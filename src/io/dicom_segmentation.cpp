// After DICOM PS3.3, A.51 "Segmentation IOD" and C.8.20 "Segmentation" (dicom.nema.org): binary segments, whose frames
// are stacked by their positions. A frame that is not there is empty.
#include "io/dicom_segmentation.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/errors.h"
#include "base/vec.h"
#include "io/cell_arrays.h"
#include "io/dicom_elements.h"
#include "io/label_image_frame.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/text_cursor.h"
#include "io/utf8.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// A data element, by its tag and its name in messages.
struct Element {
  DicomTag tag;
  const char* name;
};

constexpr Element kRows = {0x00280010, "Rows"};
constexpr Element kColumns = {0x00280011, "Columns"};
constexpr Element kFrames = {0x00280008, "NumberOfFrames"};
constexpr Element kBits = {0x00280100, "BitsAllocated"};
constexpr Element kKind = {0x00620001, "SegmentationType"};
constexpr Element kSegments = {0x00620002, "SegmentSequence"};
constexpr Element kSegmentNumber = {0x00620004, "SegmentNumber"};
constexpr Element kSegmentLabel = {0x00620005, "SegmentLabel"};
constexpr Element kShared = {0x52009229, "SharedFunctionalGroupsSequence"};
constexpr Element kPerFrame = {0x52009230, "PerFrameFunctionalGroupsSequence"};
constexpr Element kIdentification = {0x0062000A, "SegmentIdentificationSequence"};
constexpr Element kReferenced = {0x0062000B, "ReferencedSegmentNumber"};
constexpr Element kPlanePosition = {0x00209113, "PlanePositionSequence"};
constexpr Element kPosition = {0x00200032, "ImagePositionPatient"};
constexpr Element kPlaneOrientation = {0x00209116, "PlaneOrientationSequence"};
constexpr Element kOrientation = {0x00200037, "ImageOrientationPatient"};
constexpr Element kMeasures = {0x00289110, "PixelMeasuresSequence"};
constexpr Element kPixelSpacing = {0x00280030, "PixelSpacing"};
constexpr Element kBetweenSlices = {0x00180088, "SpacingBetweenSlices"};
constexpr Element kThickness = {0x00180050, "SliceThickness"};
constexpr Element kPixels = {0x7FE00010, "PixelData"};

/// Data elements, of the file or of an item in one of its sequences. Path and elements must outlive it.
class Item {
 public:
  Item(const fs::path& path, const DicomElements& elements) : path_(&path), elements_(&elements) {}

  /// The bytes of an element; empty where there is none.
  std::string_view bytes(const Element& element) const {
    const auto found = elements_->values.find(element.tag);
    return found == elements_->values.end() ? std::string_view() : found->second;
  }

  /// Without the spaces and zero bytes that fill it up.
  std::string_view text(const Element& element) const {
    const std::string_view all = bytes(element);
    return trimmed(all.substr(0, all.find('\0')));
  }

  std::uint16_t u16(const Element& element) const {
    std::uint16_t number = 0;
    const std::string_view all = bytes(element);
    if (all.size() < sizeof(number)) fail_without(element);
    std::memcpy(&number, all.data(), sizeof(number));
    return number;
  }

  /// Numbers written as text with "\" between them.
  std::vector<double> numbers(const Element& element, std::size_t count) const {
    std::string_view rest = text(element);
    std::vector<double> values;
    while (values.size() < count) {
      const std::string_view word = trimmed(rest.substr(0, rest.find('\\')));
      double value = 0;
      const char* const begin = word.data() + (word.starts_with('+') ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
      if (word.empty() || error != std::errc() || end != word.data() + word.size()) fail_without(element);
      values.push_back(value);
      rest.remove_prefix(std::min(rest.find('\\'), rest.size() - 1) + 1);
    }
    return values;
  }

  /// Those of a sequence; none where it is not there.
  std::vector<Item> items(const Element& sequence) const {
    std::vector<Item> all;
    const auto found = elements_->sequences.find(sequence.tag);
    if (found == elements_->sequences.end()) return all;
    for (const DicomElements& item : found->second) all.emplace_back(*path_, item);
    return all;
  }

  bool has(const Element& element) const { return elements_->values.contains(element.tag); }
  const fs::path& path() const { return *path_; }
  [[noreturn]] void fail_without(const Element& element) const {
    throw_damaged(*path_, std::string("its ").append(element.name).append(" is missing or wrong"));
  }

 private:
  const fs::path* path_;
  const DicomElements* elements_;
};

/// The item of a functional group: that of the frame, else the one that all frames share.
Item group_of(const Item& frame, const Item& shared, const Element& sequence) {
  for (const Item* where : {&frame, &shared}) {
    if (const std::vector<Item> items = where->items(sequence); !items.empty()) return items.front();
  }
  frame.fail_without(sequence);
}

Vec3 vector_in(const Item& item, const Element& element) {
  const std::vector<double> v = item.numbers(element, 3);
  return {v[0], v[1], v[2]};
}

/// What a segmentation says of itself as a whole.
struct Masks {
  std::size_t rows = 0, columns = 0;
  std::vector<Item> frames;  ///< their functional groups
  Item shared;
  std::string_view bits;  ///< one a voxel, the frames one after the other
};

/// Throws unless the masks are binary, and as many bits as are declared.
Masks masks_of(const Item& file) {
  const std::vector<Item> shared = file.items(kShared);
  Masks masks = {file.u16(kRows), file.u16(kColumns), file.items(kPerFrame), shared.empty() ? file : shared.front(),
                 file.bytes(kPixels)};
  if (file.text(kKind) != "BINARY" || file.u16(kBits) != 1) {
    throw InvalidInput(in_quotes(file.path()) + " holds segments of type '" + std::string(file.text(kKind)) +
                       "' with " + number_text(file.u16(kBits)) + " bits a voxel; BINARY ones with 1 bit are needed");
  }
  if (masks.rows == 0) file.fail_without(kRows);
  if (masks.columns == 0) file.fail_without(kColumns);
  if (masks.frames.empty()) file.fail_without(kPerFrame);
  if (file.numbers(kFrames, 1).front() != static_cast<double>(masks.frames.size())) file.fail_without(kFrames);
  const std::size_t bytes = (masks.frames.size() * masks.rows * masks.columns + 7) / 8;
  if (masks.bits.size() < bytes) {
    throw_damaged(file.path(), "it has " + number_text(masks.bits.size()) + " of the " + number_text(bytes) +
                                   " bytes of its uncompressed voxels");
  }
  return masks;
}

/// Names by number, of all segments.
LabelTable segments_of(const Item& file) {
  LabelTable names;
  for (const Item& segment : file.items(kSegments)) {
    const std::string_view name = segment.text(kSegmentLabel);
    names[segment.u16(kSegmentNumber)].name = is_one_line_of_utf8(name) ? name : std::string_view();
  }
  if (names.empty()) file.fail_without(kSegments);
  return names;
}

/// The frames in space: a stack of slices, in which each frame has its place.
struct Stack {
  ImageGeometry geometry;
  std::size_t slices = 1;
  std::vector<std::size_t> slice_of_frame;
};

/// Where the centre of the first voxel of each frame lies.
std::vector<Vec3> positions_of(const Masks& masks) {
  std::vector<Vec3> positions;
  for (const Item& frame : masks.frames) {
    positions.push_back(vector_in(group_of(frame, masks.shared, kPlanePosition), kPosition));
  }
  return positions;
}

/// Axes and spacing of the slices but for their distance. Throws unless all frames lie alike.
ImageGeometry plane_of(const Masks& masks) {
  constexpr double kTurn = 1e-4;
  const auto axes_of = [&](const Item& frame) {
    return group_of(frame, masks.shared, kPlaneOrientation).numbers(kOrientation, 6);
  };
  const std::vector<double> axes = axes_of(masks.frames.front());
  for (const Item& frame : masks.frames) {
    const std::vector<double> others = axes_of(frame);
    for (std::size_t n = 0; n < 6; ++n) {
      if (std::abs(axes[n] - others[n]) <= kTurn) continue;
      throw InvalidInput(in_quotes(frame.path()) + " has frames of different orientation; resample it to one grid");
    }
  }
  const Vec3 across = {axes[0], axes[1], axes[2]}, down = {axes[3], axes[4], axes[5]}, normal = cross(across, down);
  const Item measures = group_of(masks.frames.front(), masks.shared, kMeasures);
  const std::vector<double> spacing = measures.numbers(kPixelSpacing, 2);  // between rows, between columns
  ImageGeometry plane;
  for (std::size_t row = 0; row < 3; ++row) plane.direction[row] = {across[row], down[row], normal[row]};
  plane.spacing_mm = {spacing[1], spacing[0], 0};
  return plane;
}

/// The distance of slices: as said, else the smallest between two frames, else the thickness of the only slice.
double slice_distance(const Masks& masks, std::vector<double> depths) {
  const Item measures = group_of(masks.frames.front(), masks.shared, kMeasures);
  if (measures.has(kBetweenSlices)) return measures.numbers(kBetweenSlices, 1).front();
  constexpr double kSamePlace = 1e-3;  // mm
  std::ranges::sort(depths);
  double smallest = 0;
  for (std::size_t n = 1; n < depths.size(); ++n) {
    const double step = depths[n] - depths[n - 1];
    if (step > kSamePlace && (smallest == 0 || step < smallest)) smallest = step;
  }
  return smallest > 0 ? smallest : measures.numbers(kThickness, 1).front();
}

/// Throws unless the frames fit into a stack of evenly spaced slices.
Stack stack_of(const fs::path& path, const Masks& masks) {
  constexpr double kMostSlices = 1 << 14;  // more are a wrong distance
  constexpr double kUnevenness = 0.02;     // of the distance
  Stack stack;
  stack.geometry = plane_of(masks);
  const Vec3 normal = {stack.geometry.direction[0][2], stack.geometry.direction[1][2], stack.geometry.direction[2][2]};
  const std::vector<Vec3> positions = positions_of(masks);
  std::vector<double> depths;
  for (const Vec3 position : positions) depths.push_back(dot(normal, position));
  const auto first = static_cast<std::size_t>(std::ranges::min_element(depths) - depths.begin());
  const double distance = slice_distance(masks, depths);
  stack.geometry.spacing_mm.z = distance;
  stack.geometry.origin_mm = positions[first];
  stack.geometry = checked_geometry(path, stack.geometry);
  for (std::size_t f = 0; f < positions.size(); ++f) {
    const double slice = std::round((depths[f] - depths[first]) / distance);
    const double off = norm(positions[f] - positions[first] - (slice * distance) * normal);
    if (!(off <= kUnevenness * distance) || slice >= kMostSlices) {
      throw InvalidInput("frame " + number_text(f + 1) + " of " + in_quotes(path) + " is " + number_text(off) +
                         " mm off a stack of slices " + number_text(distance) + " mm apart; resample it to one grid");
    }
    stack.slice_of_frame.push_back(static_cast<std::size_t>(slice));
    stack.slices = std::max(stack.slices, stack.slice_of_frame.back() + 1);
  }
  return stack;
}

/// Gives the voxels of a frame the label; a larger one that is there already stays. Returns how many had another.
std::uint64_t put_frame(const Masks& masks, std::size_t frame, Label label, Label* slice) {
  std::uint64_t shared = 0;
  const std::size_t voxels = masks.rows * masks.columns, first = frame * voxels;
  for (std::size_t n = 0; n < voxels; ++n) {
    const auto byte = static_cast<unsigned char>(masks.bits[(first + n) / 8]);
    if ((byte >> (first + n) % 8 & 1U) == 0) continue;
    shared += slice[n] != 0 && slice[n] != label ? 1 : 0;
    slice[n] = std::max(slice[n], label);
  }
  return shared;
}

ImageFile image_of(const Item& file) {
  const fs::path& path = file.path();
  const Masks masks = masks_of(file);
  const Stack stack = stack_of(path, masks);
  ImageFile result;
  result.image = blank_image(path, {masks.columns, masks.rows, stack.slices}, stack.geometry, 0);
  result.image.names = segments_of(file);
  std::uint64_t shared = 0;
  for (std::size_t f = 0; f < masks.frames.size(); ++f) {
    const Label label = group_of(masks.frames[f], masks.shared, kIdentification).u16(kReferenced);
    if (label == 0 || !result.image.names.contains(label)) {
      throw_damaged(path, "frame " + number_text(f + 1) + " belongs to the segment " + number_text(label) +
                              ", which is not there");
    }
    shared +=
        put_frame(masks, f, label, result.image.voxels.data() + stack.slice_of_frame[f] * masks.rows * masks.columns);
  }
  if (shared > 0) {
    result.notes.push_back(number_text(shared) + " voxels of segments of " + in_quotes(path) +
                           " lie in another one, too; the one of the larger number has them");
  }
  return result;
}

}  // namespace

bool is_dicom_segmentation(const fs::path& path) {
  constexpr std::size_t kPreamble = 128, kLooked = 1024;
  constexpr std::string_view kClass = {
      "\x02\0\x02\0UI\x1c\0"
      "1.2.840.10008.5.1.4.1.1.66.4\0",
      36};
  std::string start(kLooked, '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), kLooked);
  const std::string_view text = start;
  return text.substr(kPreamble, 4) == "DICM" && text.find(kClass) != std::string_view::npos;
}

ImageFile read_dicom_segmentation(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const DicomElements elements = dicom_elements(path, file);
  return image_of({path, elements});
}

}  // namespace anatomesh
