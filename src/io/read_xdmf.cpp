// After "XDMF Model and Format" (https://www.xdmf.org/index.php/XDMF_Model_and_Format), versions 2 and 3, and what
// meshio, FEniCS and VTK make of it: attributes are called Type or TopologyType, NumberType or DataType.
#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/cell_arrays.h"
#include "io/hdf5_file.h"
#include "io/label_colour.h"
#include "io/number_text.h"
#include "io/output_file.h"
#include "io/text_cursor.h"
#include "io/xdmf_mesh.h"

namespace anatomesh {
namespace {

constexpr std::int64_t kVtkOther = 0;
constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 40;  // in one DataItem

/// Corners of a kind of cell in a mixed topology; 0: their number stands before them.
struct MixedKind {
  std::int64_t code;
  std::size_t corners;
};
constexpr std::int64_t kTetrahedronCode = 6, kQuadraticCode = 0x26;
constexpr std::array kMixedKinds = {
    MixedKind{1, 0},     MixedKind{2, 0},     MixedKind{3, 0},     MixedKind{4, 3},     MixedKind{5, 4},
    MixedKind{6, 4},     MixedKind{7, 5},     MixedKind{8, 6},     MixedKind{9, 8},     MixedKind{0x22, 3},
    MixedKind{0x23, 9},  MixedKind{0x24, 6},  MixedKind{0x25, 8},  MixedKind{0x26, 10}, MixedKind{0x27, 13},
    MixedKind{0x28, 15}, MixedKind{0x29, 18}, MixedKind{0x30, 20}, MixedKind{0x31, 24}, MixedKind{0x32, 27},
};

std::int64_t vtk_type_of(std::int64_t mixed_code) {
  return mixed_code == kTetrahedronCode ? kVtkTetra : mixed_code == kQuadraticCode ? kVtkQuadraticTetra : kVtkOther;
}

/// A topology of one kind of tetrahedra.
struct TetKind {
  std::string_view name;
  std::int64_t vtk_type;
  std::size_t nodes;
};
constexpr std::array<TetKind, 4> kTetKinds = {{{"tetrahedron", kVtkTetra, 4},
                                               {"tetrahedron_10", kVtkQuadraticTetra, 10},
                                               {"tet_10", kVtkQuadraticTetra, 10},
                                               {"tetrahedron10", kVtkQuadraticTetra, 10}}};

/// The value of the first of two attributes that is there, in small letters.
std::string either(const pugi::xml_node& node, const char* one, const char* other) {
  const pugi::xml_attribute found = node.attribute(one) ? node.attribute(one) : node.attribute(other);
  return in_small_letters(found.value());
}

template <typename Number>
bool is_number(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty();
}

/// One file while it is read.
class XdmfReader {
 public:
  explicit XdmfReader(const std::filesystem::path& path) : path_(path) {
    const pugi::xml_parse_result parsed = document_.load_file(path.c_str());
    if (!parsed) throw_damaged(path, std::string("byte ") + number_text(parsed.offset) + ": " + parsed.description());
    if (!document_.child("Xdmf")) throw_damaged(path, "it has no element Xdmf");
  }

  TetMesh read() {
    const pugi::xml_node grid = chosen_grid();
    CellArrays cells;
    if (grid) {
      read_topology(grid.child("Topology"), cells);
      read_points(cells);
      read_attributes(grid, cells);
    } else {
      cells.offsets = {0};
    }
    TetMesh mesh = tet_mesh_from(path_, std::move(cells));
    mesh.names = label_table(grid);
    return mesh;
  }

 private:
  // ---- the elements

  static bool has_tets(const pugi::xml_node& node) {
    const std::string type = either(node.child("Topology"), "TopologyType", "Type");
    const bool is_known = type == "mixed" || std::ranges::find(kTetKinds, type, &TetKind::name) != kTetKinds.end();
    return std::string_view(node.name()) == "Grid" && is_known;
  }

  static bool is_of_cells(const pugi::xml_node& attribute) {
    return in_small_letters(attribute.attribute("Center").value()) == "cell";
  }

  // FEniCS puts the tags of the cells into a grid of their own.
  pugi::xml_node chosen_grid() const {
    const pugi::xml_node tagged = document_.find_node([](const pugi::xml_node& node) {
      if (!has_tets(node)) return false;
      const auto attributes = node.children("Attribute");
      return std::any_of(attributes.begin(), attributes.end(), &XdmfReader::is_of_cells);
    });
    return tagged ? tagged : document_.find_node(&XdmfReader::has_tets);
  }

  // That of the grid itself, or the first in the file, which others include.
  pugi::xml_node geometry() const {
    const pugi::xml_node own = chosen_grid().child("Geometry");
    if (own.child("DataItem")) return own;
    return document_.find_node([](const pugi::xml_node& node) {
      return std::string_view(node.name()) == "Geometry" && node.child("DataItem");
    });
  }

  void read_topology(const pugi::xml_node& topology, CellArrays& cells) {
    const std::vector<std::int64_t> numbers = integers(item_of(topology));
    cells.offsets = {0};
    const std::string type = either(topology, "TopologyType", "Type");
    if (type == "mixed") return read_mixed(numbers, cells);
    const TetKind& kind = *std::ranges::find(kTetKinds, type, &TetKind::name);  // see has_tets()
    if (numbers.size() % kind.nodes != 0) fail("its tetrahedra have " + number_text(numbers.size()) + " nodes");
    for (std::size_t end = kind.nodes; end <= numbers.size(); end += kind.nodes) {
      cells.offsets.push_back(static_cast<std::int64_t>(end));
    }
    cells.types.assign(numbers.size() / kind.nodes, kind.vtk_type);
    cells.corners = numbers;
  }

  void read_mixed(const std::vector<std::int64_t>& numbers, CellArrays& cells) const {
    for (std::size_t at = 0; at < numbers.size();) {
      const std::int64_t code = numbers[at++];
      const auto kind = std::ranges::find(kMixedKinds, code, &MixedKind::code);
      if (kind == kMixedKinds.end()) fail("its mixed cells have the unknown kind " + number_text(code));
      std::uint64_t corners = kind->corners;
      if (corners == 0 && at < numbers.size()) corners = static_cast<std::uint64_t>(numbers[at++]);
      if (corners > numbers.size() - at) fail("its last cell lacks corners");
      const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(at);
      cells.corners.insert(cells.corners.end(), begin, begin + static_cast<std::ptrdiff_t>(corners));
      cells.offsets.push_back(static_cast<std::int64_t>(cells.corners.size()));
      cells.types.push_back(vtk_type_of(code));
      at += corners;
    }
  }

  void read_points(CellArrays& cells) {
    const pugi::xml_node from = geometry();
    const std::string type = either(from, "GeometryType", "Type");
    const std::size_t columns = type == "xy" ? 2 : 3;
    if (!type.empty() && type != "xy" && type != "xyz") fail("its geometry is " + in_quotes(type) + ", not XYZ or XY");
    const std::vector<double> numbers = reals(item_of(from));
    if (numbers.size() % columns != 0) fail("its points have " + number_text(numbers.size()) + " coordinates");
    cells.points_mm.resize(numbers.size() / columns);
    for (std::size_t n = 0; n < numbers.size(); ++n) cells.points_mm[n / columns][n % columns] = numbers[n];
  }

  void read_attributes(const pugi::xml_node& grid, CellArrays& cells) {
    for (const pugi::xml_node& attribute : grid.children("Attribute")) {
      if (!is_of_cells(attribute)) continue;
      const pugi::xml_node item = item_of(attribute);
      if (count_of(item) != cells.types.size()) continue;  // several values a cell
      CellArray array{attribute.attribute("Name").value(), {}};
      array.values =
          holds_reals(item) ? array_of(NumberType::f64, reals(item)) : array_of(NumberType::i64, integers(item));
      cells.arrays.push_back(std::move(array));
    }
  }

  template <typename Value>
  static NumberArray array_of(NumberType type, const std::vector<Value>& values) {
    const auto* const begin = reinterpret_cast<const std::byte*>(values.data());
    return {type, {begin, begin + values.size() * sizeof(Value)}};
  }

  // Information of other kinds is left alone.
  static LabelTable label_table(const pugi::xml_node& grid) {
    LabelTable names;
    for (const pugi::xml_node& information : grid.children("Information")) {
      pugi::xml_document maps;
      if (!maps.load_string(information.text().get())) continue;
      for (const pugi::xml_node& map : maps.document_element().children("map")) {
        Label label = 0;
        if (std::string_view(map.attribute("dim").value()) != "3" || !is_number(trimmed(map.text().get()), label))
          continue;
        names[label] = {map.attribute("key").value(), colour_from(map.attribute("colour").value())};
      }
    }
    return names;
  }

  // ---- the numbers

  pugi::xml_node item_of(const pugi::xml_node& parent) const {
    const pugi::xml_node item = parent.child("DataItem");
    if (!item) fail(std::string("its element ") + parent.name() + " has no DataItem");
    if (item.attribute("Reference")) fail("a DataItem refers to another, which is not supported");
    const std::string format = in_small_letters(item.attribute("Format").value());
    if (format != "xml" && format != "hdf" && !format.empty()) {
      fail("a DataItem has the format " + in_quotes(format) + "; XML and HDF can be read");
    }
    return item;
  }

  static bool is_hdf(const pugi::xml_node& item) { return in_small_letters(item.attribute("Format").value()) == "hdf"; }

  std::uint64_t count_of(const pugi::xml_node& item) const {
    TextCursor shape(path_, item.attribute("Dimensions").value());
    std::uint64_t count = 1;
    bool is_empty = true;
    for (std::string_view word = shape.word(); !word.empty(); word = shape.word(), is_empty = false) {
      std::uint64_t size = 0;
      if (!is_number(word, size) || __builtin_mul_overflow(count, size, &count) || count > kMostNumbers) {
        fail("a DataItem has the dimensions " + in_quotes(item.attribute("Dimensions").value()));
      }
    }
    if (is_empty) fail("a DataItem has no dimensions");
    return count;
  }

  bool holds_reals(const pugi::xml_node& item) {
    if (is_hdf(item)) return h5_of(item).holds_reals(dataset_of(item));
    const std::string type = either(item, "NumberType", "DataType");
    return type.empty() || type == "float";
  }

  std::vector<double> reals(const pugi::xml_node& item) {
    return is_hdf(item) ? h5_of(item).reals(dataset_of(item), count_of(item)) : numbers_in_xml<double>(item);
  }

  std::vector<std::int64_t> integers(const pugi::xml_node& item) {
    return is_hdf(item) ? h5_of(item).integers(dataset_of(item), count_of(item)) : numbers_in_xml<std::int64_t>(item);
  }

  template <typename Number>
  std::vector<Number> numbers_in_xml(const pugi::xml_node& item) const {
    const std::uint64_t count = count_of(item);
    TextCursor text(path_, item.text().get());
    if (count > (text.bytes_left() + 1) / 2) fail("a DataItem has fewer numbers than its dimensions say");
    std::vector<Number> numbers;
    numbers.reserve(count);
    for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
      Number value{};
      if (!is_number(word, value)) fail(in_quotes(word.substr(0, 40)) + " stands where a number should");
      numbers.push_back(value);
    }
    if (numbers.size() != count) {
      fail("a DataItem has " + number_text(numbers.size()) + " numbers, not " + number_text(count));
    }
    return numbers;
  }

  // "file.h5:/dataset", where the file lies beside this one.
  std::pair<std::string, std::string> place_of(const pugi::xml_node& item) const {
    const std::string_view place = trimmed(item.text().get());
    const std::size_t colon = place.rfind(':');
    if (colon == std::string_view::npos || colon == 0) fail(in_quotes(place.substr(0, 40)) + " names no dataset");
    return {std::string(place.substr(0, colon)), std::string(place.substr(colon + 1))};
  }

  std::string dataset_of(const pugi::xml_node& item) const { return place_of(item).second; }

  const Hdf5File& h5_of(const pugi::xml_node& item) {
    const std::string name = place_of(item).first;
    return h5_.try_emplace(name, path_.parent_path() / name).first->second;
  }

  [[noreturn]] void fail(const std::string& why) const { throw_damaged(path_, why); }

  std::filesystem::path path_;
  pugi::xml_document document_;
  std::map<std::string, Hdf5File> h5_;
};

}  // namespace

TetMesh read_xdmf(const std::filesystem::path& path) { return XdmfReader(path).read(); }

}  // namespace anatomesh
