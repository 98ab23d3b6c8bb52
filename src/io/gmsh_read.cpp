// After "MSH file format", versions 4.1 and 2.2, of Gmsh's reference manual.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "io/gmsh_mesh.h"
#include "io/label_values.h"
#include "io/number_text.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/set_names.h"
#include "io/text_cursor.h"

namespace anatomesh {
namespace {

constexpr int kTetrahedron = 4, kQuadraticTetrahedron = 11;

bool is_tetrahedron(int type) { return type == kTetrahedron || type == kQuadraticTetrahedron; }

/// Corners of each kind of element from 1 on, 0 for those that are not known.
constexpr std::array<std::size_t, 94> corner_counts() {
  constexpr std::array<std::size_t, 31> kFirst = {2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1, 8,
                                                  20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  std::array<std::size_t, 94> counts{};
  for (std::size_t n = 0; n < kFirst.size(); ++n) counts[n + 1] = kFirst[n];
  counts[92] = 64;
  counts[93] = 125;
  return counts;
}

constexpr std::array<std::size_t, 94> kCornerCounts = corner_counts();

/// Reads one file from its start to its end.
class GmshReader {
 public:
  explicit GmshReader(const std::filesystem::path& path) : text_(path) {}

  TetMesh read() {
    read_format();
    for (std::string_view section = text_.word(); !section.empty(); section = text_.word()) {
      read_section(std::string(section));
    }
    if (!has_elements_) text_.fail("it has no $Elements");
    TetMesh mesh = tet_mesh_from(text_.path(), std::move(mesh_));
    mesh.names = std::move(names_);
    return mesh;
  }

 private:
  // ---- numbers

  template <typename Number>
  Number next() {
    if (!is_binary_) return text_.number<Number>();
    std::array<char, sizeof(Number)> bytes;
    std::ranges::copy(text_.take(sizeof(Number)), bytes.begin());
    if (is_swapped_) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  /// A number of things that each take at least so many bytes, as text or not.
  std::size_t next_count(std::size_t least_as_text, std::size_t least_binary) {
    if (!is_binary_) return text_.count_of(least_as_text);
    const auto count = next<std::uint64_t>();
    if (count > text_.bytes_left() / least_binary) text_.fail("it ends too early");
    return count;
  }

  template <typename Number>
  void skip(std::size_t count) {
    for (std::size_t n = 0; n < count; ++n) next<Number>();
  }

  Vec3 next_point() {
    Vec3 point;
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = next<double>();
    return point;
  }

  // ---- sections

  void read_format() {
    if (text_.word() != "$MeshFormat") text_.fail("it does not begin with $MeshFormat");
    const std::string version(text_.word());
    is_version_4_ = version == "4.1";
    constexpr std::array<std::string_view, 5> kKnown = {"4.1", "2.2", "2.1", "2.0", "2"};
    if (std::ranges::find(kKnown, version) == kKnown.end()) {
      throw InvalidInput(in_quotes(text_.path()) + " is in version '" + version.substr(0, 40) +
                         "' of Gmsh's format; 4.1 and 2.2 can be read");
    }
    const bool is_binary = text_.number<int>() != 0;
    if (text_.number<int>() != 8 && is_binary) text_.fail("its numbers are not of 8 bytes");
    text_.line();
    is_binary_ = is_binary;
    if (is_binary) read_byte_order();
    end_section("$MeshFormat");
  }

  void read_byte_order() {
    const auto one = next<std::int32_t>();
    is_swapped_ = one != 1;
    if (one != 1 && one != 0x01000000) text_.fail("its byte order is not known");
  }

  void read_section(const std::string& name) {
    struct Named {
      std::string_view name;
      void (GmshReader::*read_4)();
      void (GmshReader::*read_2)();
    };
    static constexpr std::array<Named, 5> kSections = {
        {{"$PhysicalNames", &GmshReader::names, &GmshReader::names},
         {"$Entities", &GmshReader::entities, nullptr},
         {"$PartitionedEntities", &GmshReader::partitioned_entities, nullptr},
         {"$Nodes", &GmshReader::points_4, &GmshReader::points_2},
         {"$Elements", &GmshReader::elements_4, &GmshReader::elements_2}}};
    if (name.front() != '$') text_.fail(in_quotes(name.substr(0, 40)) + " stands where a section should begin");
    text_.line();
    const auto found = std::ranges::find(kSections, name, &Named::name);
    const auto read = found == kSections.end() ? nullptr : is_version_4_ ? found->read_4 : found->read_2;
    if (read == nullptr) return skip_section(name);
    (this->*read)();
    end_section(name);
  }

  static std::string end_of(const std::string& section) { return std::string("$End").append(section, 1); }

  void end_section(const std::string& name) {
    if (text_.word() != end_of(name)) text_.fail(name + " does not end with " + end_of(name));
  }

  void skip_section(const std::string& name) {
    const std::string end = end_of(name);
    while (!text_.at_end()) {
      if (trimmed(text_.line()) == end) return;
    }
    text_.fail(name.substr(0, 40) + " has no end");
  }

  /// As text in binary files, too.
  void names() {
    for (std::size_t left = text_.count_of(8); left > 0; --left) {
      const int dimension = text_.number<int>();
      const auto tag = text_.number<std::int64_t>();
      const std::string_view quoted = trimmed(text_.line());
      if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"') text_.fail("a group has no name");
      const std::string name(quoted.substr(1, quoted.size() - 2));
      if (dimension != 3 || !is_label(tag)) continue;
      const auto label = static_cast<Label>(tag);
      if (!name.empty() && name != default_set_name(label)) names_[label].name = name;
    }
  }

  void entities() {
    std::array<std::uint64_t, 4> counts;
    for (std::uint64_t& count : counts) count = next<std::uint64_t>();
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::uint64_t n = 0; n < counts[static_cast<std::size_t>(dimension)]; ++n) entity(dimension);
    }
  }

  void entity(int dimension) {
    const auto tag = next<std::int32_t>();
    entity_body(dimension, tag, tag);
  }

  /// What follows the tag. The volume has the number of its first group, else of its own.
  void entity_body(int dimension, std::int32_t tag, std::int64_t otherwise) {
    skip<double>(dimension == 0 ? 3 : 6);
    std::optional<std::int64_t> group;
    for (std::size_t left = next_count(2, 4); left > 0; --left) {
      const std::int64_t found = next<std::int32_t>();
      if (!group) group = std::abs(found);
    }
    if (dimension > 0) skip<std::int32_t>(next_count(2, 4));
    if (dimension == 3) number_of_volume_[tag] = group.value_or(otherwise);
  }

  void partitioned_entities() {
    next<std::uint64_t>();
    skip<std::int32_t>(2 * next_count(4, 8));
    std::array<std::uint64_t, 4> counts;
    for (std::uint64_t& count : counts) count = next<std::uint64_t>();
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::uint64_t n = 0; n < counts[static_cast<std::size_t>(dimension)]; ++n) partitioned_entity(dimension);
    }
  }

  void partitioned_entity(int dimension) {
    const auto tag = next<std::int32_t>();
    const auto parent_dimension = next<std::int32_t>(), parent = next<std::int32_t>();
    skip<std::int32_t>(next_count(2, 4));
    entity_body(dimension, tag, parent_dimension == 3 ? number_of(parent) : tag);
  }

  std::int64_t number_of(std::int32_t volume) const {
    const auto found = number_of_volume_.find(volume);
    return found == number_of_volume_.end() ? volume : found->second;
  }

  void points_4() {
    const auto blocks = next<std::uint64_t>();
    skip<std::uint64_t>(3);
    for (std::uint64_t block = 0; block < blocks; ++block) {
      const auto dimension = next<std::int32_t>();
      next<std::int32_t>();
      const bool is_parametric = next<std::int32_t>() != 0;
      const std::size_t begin = mesh_.points.size();
      mesh_.points.resize(begin + next_count(8, 32));
      for (std::size_t n = begin; n < mesh_.points.size(); ++n) mesh_.points[n].number = next_number();
      for (std::size_t n = begin; n < mesh_.points.size(); ++n) {
        mesh_.points[n].place_mm = next_point();
        if (is_parametric) skip<double>(static_cast<std::size_t>(std::clamp(dimension, 0, 3)));
      }
    }
  }

  /// Of a point or an element, in version 4.1.
  std::int64_t next_number() {
    const auto number = next<std::uint64_t>();
    if (number > INT64_MAX) text_.fail(number_text(number) + " is too large a number");
    return static_cast<std::int64_t>(number);
  }

  std::size_t corners_of(std::int32_t type) const {
    const std::size_t count = type > 0 && static_cast<std::size_t>(type) < kCornerCounts.size()
                                  ? kCornerCounts[static_cast<std::size_t>(type)]
                                  : 0;
    if (count == 0) text_.fail("it has elements of type " + number_text(type) + ", which is not known");
    return count;
  }

  void elements_4() {
    has_elements_ = true;
    const auto blocks = next<std::uint64_t>();
    skip<std::uint64_t>(3);
    for (std::uint64_t block = 0; block < blocks; ++block) {
      next<std::int32_t>();
      const auto volume = next<std::int32_t>(), type = next<std::int32_t>();
      const std::size_t corners = corners_of(type);
      const std::size_t count = next_count(2 * (corners + 1), 8 * (corners + 1));
      if (!is_tetrahedron(type)) {
        skip<std::uint64_t>(count * (corners + 1));
        continue;
      }
      nodes_.resize(corners);
      for (std::size_t n = 0; n < count; ++n) {
        const std::int64_t number = next_number();
        for (std::int64_t& node : nodes_) node = next_number();
        keep(number, number_of(volume));
      }
    }
  }

  /// The count is text in binary files, too.
  std::size_t count_2(std::size_t least_as_text, std::size_t least_binary) {
    const std::size_t count = text_.count_of(is_binary_ ? least_binary : least_as_text);
    text_.line();
    return count;
  }

  void points_2() {
    mesh_.points.resize(count_2(8, 28));
    for (NumberedPoint& point : mesh_.points) {
      point.number = next<std::int32_t>();
      point.place_mm = next_point();
    }
  }

  void elements_2() {
    has_elements_ = true;
    const std::size_t count = count_2(6, 8);
    for (std::size_t done = 0; done < count;) done += is_binary_ ? block_2() : line_2();
  }

  std::size_t line_2() {
    const auto number = next<std::int32_t>(), type = next<std::int32_t>(), tags = next<std::int32_t>();
    element_2(number, type, tags);
    return 1;
  }

  std::size_t block_2() {
    const auto type = next<std::int32_t>(), count = next<std::int32_t>(), tags = next<std::int32_t>();
    if (count < 1) text_.fail("it has a block of " + number_text(count) + " elements");
    for (std::int32_t n = 0; n < count; ++n) element_2(next<std::int32_t>(), type, tags);
    return static_cast<std::size_t>(count);
  }

  /// Of the tags, the first is the group, 0 where there is none, and the second the volume.
  void element_2(std::int32_t number, std::int32_t type, std::int32_t tags) {
    std::int64_t group = 0;
    for (std::int32_t n = 0; n < tags; ++n) {
      const auto tag = next<std::int32_t>();
      if (n < 2 && group == 0) group = tag;
    }
    const std::size_t corners = corners_of(type);
    if (!is_tetrahedron(type)) return skip<std::int32_t>(corners);
    nodes_.resize(corners);
    for (std::int64_t& node : nodes_) node = next<std::int32_t>();
    keep(number, tags < 1 ? 1 : group);
  }

  void keep(std::int64_t number, std::int64_t label) {
    if (!is_label(label)) {
      throw InvalidInput("element " + number_text(number) + " of " + in_quotes(text_.path()) + " is in the group " +
                         number_text(label) + "; " + kLabelRule);
    }
    mesh_.add(number, nodes_, static_cast<Label>(label), kGmshOrder);
  }

  TextCursor text_;
  bool is_version_4_ = false;
  bool is_binary_ = false;
  bool is_swapped_ = false;
  bool has_elements_ = false;
  std::map<std::int32_t, std::int64_t> number_of_volume_;
  std::vector<std::int64_t> nodes_;  // of the present tetrahedron
  NumberedMesh mesh_;
  LabelTable names_;
};

}  // namespace

TetMesh read_gmsh(const std::filesystem::path& path) { return GmshReader(path).read(); }

}  // namespace anatomesh
