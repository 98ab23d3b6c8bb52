// After "VTK XML Formats" of VTK's documentation, the part on unstructured grids.
#include "io/vtu_cells.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/number_text.h"
#include "io/vtk_xml_file.h"

namespace anatomesh {
namespace {

/// Reads the pieces of one file.
class VtuReader {
 public:
  explicit VtuReader(const std::filesystem::path& path) : file_(path, "UnstructuredGrid") {}

  CellArrays read() {
    take_names(file_.data_set().child("FieldData"));
    cells_.offsets = {0};
    for (const pugi::xml_node piece : file_.data_set().children("Piece")) read_piece(piece);
    return std::move(cells_);
  }

 private:
  /// The array of this name; none where there is none.
  static pugi::xml_node array_in(pugi::xml_node section, std::string_view name) {
    return section.find_child([&](pugi::xml_node array) { return name_of(array) == name; });
  }

  void take_names(pugi::xml_node data) {
    const pugi::xml_node values = array_in(data, kNameArrays.values), names = array_in(data, kNameArrays.names);
    const pugi::xml_node colours = array_in(data, kNameArrays.colours);
    if (!number_type_of(values) || !number_type_of(names)) return;
    cells_.label_values = file_.numbers(values);
    cells_.label_names = texts_of(file_.numbers(names));
    if (number_type_of(colours)) cells_.label_colours = file_.numbers(colours);
  }

  std::size_t count(pugi::xml_node piece, const char* attribute) const {
    const std::string_view text = piece.attribute(attribute).value();
    if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) {
      throw_damaged(file_.path(), std::string("a piece has no ").append(attribute));
    }
    return piece.attribute(attribute).as_ullong();
  }

  /// Numbers of an array that must have so many.
  NumberArray numbers(pugi::xml_node array, std::string_view name, std::size_t each, std::size_t count) const {
    const ArrayPlace place{file_.path(), name};
    if (!array) place.fail("is missing");
    NumberArray result = file_.numbers(array);
    if (result.size() % each != 0 || result.size() / each != count) {
      place.fail("has " + number_text(result.size()) + " numbers for " + number_text(count) + " tuples of " +
                 number_text(each));
    }
    return result;
  }

  void read_piece(pugi::xml_node piece) {
    const std::size_t points = count(piece, "NumberOfPoints"), cells = count(piece, "NumberOfCells");
    const std::size_t points_before = cells_.points_mm.size();
    if (points > 0) {
      append(cells_.points_mm, points_of(numbers(piece.child("Points").first_child(), "Points", 3, points)));
    }
    if (cells == 0) return;
    append_cells(piece.child("Cells"), cells, points_before);
    append_labels(piece.child("CellData"), cells);
  }

  /// The first piece is taken as it is.
  template <typename Value>
  static void append(std::vector<Value>& to, std::vector<Value> from) {
    if (to.empty()) {
      to = std::move(from);
    } else {
      to.insert(to.end(), from.begin(), from.end());
    }
  }

  void append_cells(pugi::xml_node section, std::size_t count, std::size_t points_before) {
    const auto integers = [&](const char* name) {
      return integers_of(numbers(array_in(section, name), name, 1, count));
    };
    const pugi::xml_node connectivity = array_in(section, "connectivity");
    if (!connectivity) ArrayPlace{file_.path(), "connectivity"}.fail("is missing");
    std::vector<std::int64_t> corners = integers_of(file_.numbers(connectivity));
    const std::vector<std::int64_t> ends = integers("offsets");
    check_corners(corners, cells_.points_mm.size() - points_before);
    check_ends(ends, corners.size());
    const auto corners_before = static_cast<std::int64_t>(cells_.corners.size());
    cells_.offsets.reserve(cells_.offsets.size() + ends.size());
    for (const std::int64_t end : ends) cells_.offsets.push_back(corners_before + end);
    for (std::int64_t& corner : corners) corner += static_cast<std::int64_t>(points_before);
    append(cells_.corners, std::move(corners));
    append(cells_.types, integers("types"));
  }

  /// Ids of points count from the start of their piece.
  void check_corners(const std::vector<std::int64_t>& corners, std::size_t points) const {
    const auto bad = std::ranges::find_if(
        corners, [&](std::int64_t corner) { return corner < 0 || static_cast<std::size_t>(corner) >= points; });
    if (bad == corners.end()) return;
    const auto at = number_text(bad - corners.begin());
    throw_damaged(file_.path(),
                  "corner " + at + " of its cells refers to point " + number_text(*bad) + " of " + number_text(points));
  }

  void check_ends(const std::vector<std::int64_t>& ends, std::size_t corners) const {
    const bool is_sound =
        std::ranges::is_sorted(ends) && ends.front() >= 0 && static_cast<std::size_t>(ends.back()) <= corners;
    if (!is_sound) ArrayPlace{file_.path(), "offsets"}.fail("is out of order");
  }

  /// Which array it is, the first piece with cells decides.
  void append_labels(pugi::xml_node section, std::size_t count) {
    if (!has_chosen_) choose_label_array(section);
    if (cells_.arrays.empty()) return;
    CellArray& chosen = cells_.arrays.front();
    NumberArray values = numbers(array_in(section, chosen.name), chosen.name, 1, count);
    if (values.type != chosen.values.type) {
      ArrayPlace{file_.path(), chosen.name}.fail("has another type of numbers in each piece");
    }
    append(chosen.values.bytes, std::move(values.bytes));
  }

  void choose_label_array(pugi::xml_node section) {
    has_chosen_ = true;
    std::vector<CellArray> candidates;
    for (const pugi::xml_node array : section.children()) {
      const auto type = number_type_of(array);
      const bool is_scalar = array.attribute("NumberOfComponents").as_int(1) <= 1;
      if (type && is_scalar) candidates.push_back({std::string(name_of(array)), {*type, {}}});
    }
    if (const auto chosen = label_array(candidates)) cells_.arrays = {candidates[*chosen]};
  }

  VtkXmlFile file_;
  bool has_chosen_ = false;
  CellArrays cells_;
};

}  // namespace

CellArrays vtu_cells(const std::filesystem::path& path) { return VtuReader(path).read(); }

}  // namespace anatomesh
