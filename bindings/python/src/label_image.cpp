#include "label_image.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "anatomesh/errors.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;

/// The voxels of an array, which need not be aligned.
struct Voxels {
  const std::byte* first;
  std::array<std::size_t, 3> size;
  std::array<py::ssize_t, 3> stride_bytes;

  template <class Number>
  Number at(std::size_t i, std::size_t j, std::size_t k) const {
    Number value;
    const auto offset = static_cast<py::ssize_t>(i) * stride_bytes[0] + static_cast<py::ssize_t>(j) * stride_bytes[1] +
                        static_cast<py::ssize_t>(k) * stride_bytes[2];
    std::memcpy(&value, first + offset, sizeof(Number));
    return value;
  }
};

template <class Number>
bool is_label(Number value) {
  if constexpr (std::is_floating_point_v<Number>) {
    return value >= 0 && value <= Number(std::numeric_limits<Label>::max()) && value == std::trunc(value);
  } else {
    return std::in_range<Label>(value);
  }
}

/// A float can be 2^32, the number that the largest label is rounded to.
template <>
bool is_label(float value) {
  return value >= 0 && value < 4294967296.0f && value == std::trunc(value);
}

template <class Number>
[[noreturn]] void throw_no_label(std::size_t i, std::size_t j, std::size_t k, Number value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  throw InvalidInput("voxel [" + std::to_string(i) + ", " + std::to_string(j) + ", " + std::to_string(k) + "] is " +
                     std::string(digits.data(), end) + "; labels are whole numbers from 0 to 4294967295");
}

/// Tile by tile, so that neither NumPy's order nor ours goes through all of memory at every step.
template <class Number>
void copy(const Voxels& from, LabelImage& image) {
  constexpr std::size_t kTile = 32;
  const auto [ni, nj, nk] = from.size;
  const auto copy_row = [&](std::size_t i_begin, std::size_t i_end, std::size_t j, std::size_t k) {
    Label* to = &image.voxels[ni * (j + nj * k)];
    for (std::size_t i = i_begin; i < i_end; ++i) {
      const Number value = from.at<Number>(i, j, k);
      if (!is_label(value)) throw_no_label(i, j, k, value);
      to[i] = static_cast<Label>(value);
    }
  };
  for (std::size_t k_begin = 0; k_begin < nk; k_begin += kTile)
    for (std::size_t j = 0; j < nj; ++j)
      for (std::size_t i = 0; i < ni; i += kTile)
        for (std::size_t k = k_begin; k < std::min(k_begin + kTile, nk); ++k)
          copy_row(i, std::min(i + kTile, ni), j, k);
}

/// Kinds of numbers as NumPy calls them: the letter of the kind, and the bytes.
struct VoxelType {
  char kind;
  py::ssize_t bytes;
  void (*copy)(const Voxels&, LabelImage&);
};

constexpr std::array<VoxelType, 11> kVoxelTypes = {{{'b', 1, copy<std::uint8_t>},
                                                    {'u', 1, copy<std::uint8_t>},
                                                    {'u', 2, copy<std::uint16_t>},
                                                    {'u', 4, copy<std::uint32_t>},
                                                    {'u', 8, copy<std::uint64_t>},
                                                    {'i', 1, copy<std::int8_t>},
                                                    {'i', 2, copy<std::int16_t>},
                                                    {'i', 4, copy<std::int32_t>},
                                                    {'i', 8, copy<std::int64_t>},
                                                    {'f', 4, copy<float>},
                                                    {'f', 8, copy<double>}}};

const VoxelType& type_of(const py::array& voxels) {
  const py::dtype dtype = voxels.dtype();
  const auto found = std::ranges::find_if(
      kVoxelTypes, [&](const VoxelType& type) { return type.kind == dtype.kind() && type.bytes == dtype.itemsize(); });
  if (found != kVoxelTypes.end()) return *found;
  throw InvalidInput("the voxels are of type " + std::string(py::str(py::handle(dtype))) +
                     "; integers of 8 to 64 bits are needed, or floats that are whole numbers");
}

Voxels voxels_of(const py::array& array) {
  if (array.ndim() != 3) {
    throw InvalidInput("the array of voxels has " + std::to_string(array.ndim()) + " axes; three are needed: i, j, k");
  }
  Voxels voxels = {static_cast<const std::byte*>(array.data()), {}, {}};
  for (py::ssize_t a = 0; a < 3; ++a) {
    voxels.size[static_cast<std::size_t>(a)] = static_cast<std::size_t>(array.shape(a));
    voxels.stride_bytes[static_cast<std::size_t>(a)] = array.strides(a);
  }
  return voxels;
}

Vec3 vector_of(const std::array<double, 3>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

}  // namespace

LabelImage label_image_of(const py::array& array, const std::array<double, 3>& spacing_mm,
                          const std::array<double, 3>& origin_mm, const Mat3& direction,
                          const std::map<Label, std::string>& names, const std::map<Label, Colour>& colours) {
  const Voxels voxels = voxels_of(array);
  const VoxelType& type = type_of(array);
  LabelImage image = {voxels.size, vector_of(spacing_mm),         vector_of(origin_mm), direction,
                      {},          label_table_of(names, colours)};
  const py::gil_scoped_release unlocked;
  image.voxels.resize(image.size[0] * image.size[1] * image.size[2]);
  type.copy(voxels, image);
  return image;
}

void keep_labels(LabelImage& image, const std::vector<Label>& kept) {
  std::vector<Label> sorted = kept;
  std::ranges::sort(sorted);
  for (Label& label : image.voxels)
    if (!std::ranges::binary_search(sorted, label)) label = 0;
}

LabelTable label_table_of(const std::map<Label, std::string>& names, const std::map<Label, Colour>& colours) {
  LabelTable table;
  for (const auto& [label, name] : names) {
    if (name.find_first_of("\r\n") != std::string::npos)
      throw InvalidInput("the name of label " + std::to_string(label) + " goes over several lines; it must be in one");
    table[label].name = name;
  }
  for (const auto& [label, colour] : colours) table[label].colour = colour;
  return table;
}

std::map<Label, std::string> names_in(const LabelTable& table) {
  std::map<Label, std::string> names;
  for (const auto& [label, entry] : table)
    if (!entry.name.empty()) names[label] = entry.name;
  return names;
}

std::map<Label, Colour> colours_in(const LabelTable& table) {
  std::map<Label, Colour> colours;
  for (const auto& [label, entry] : table)
    if (entry.colour) colours[label] = *entry.colour;
  return colours;
}

}  // namespace anatomesh::python
