// After the "Abaqus Analysis User's Guide" (input syntax rules; nodes, elements, sets and surfaces) and G. Dhondt,
// "CalculiX CrunchiX User's Manual", version 2.20.
#include "io/abaqus_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/label_comment.h"
#include "io/mesh_surfaces.h"
#include "io/number_text.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/set_names.h"
#include "io/text_cursor.h"
#include "io/text_fields.h"
#include "io/text_output.h"

namespace anatomesh {
namespace {

constexpr NameRule kNameRule = {.identifier = true, .most_bytes = 80, .tells_case_apart = false};
constexpr std::string_view kFirstLine = "** Anatomesh: tetrahedra of labelled tissues, in mm";
constexpr std::string_view kLastLine = "** end of mesh";  // without it, the file has been cut off

// ---- writing

/// CalculiX reads the first 20 characters of a number: they must not lack the exponent of a small one.
std::string coordinate_text(double value) {
  constexpr std::size_t kMost = 20;
  std::string text = number_text(value);
  if (text.size() <= kMost || text.find("e-") == std::string::npos) return text;
  std::array<char, 400> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed).ptr;
  return {digits.data(), end};
}

void put_nodes(TextOutput& out, const TetMesh& mesh) {
  out << "*NODE\n";
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    out << n + 1;
    for (std::size_t axis = 0; axis < 3; ++axis) out << ", " << coordinate_text(mesh.points_mm[n][axis]);
    out << '\n';
  }
}

void put_elements(TextOutput& out, const TetMesh& mesh, const std::map<Label, std::string>& sets) {
  std::map<Label, std::vector<std::size_t>> tets;
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) tets[mesh.labels[n]].push_back(n);
  for (const auto& [label, members] : tets) {
    out << "*ELEMENT, TYPE=" << (is_quadratic(mesh) ? "C3D10" : "C3D4") << ", ELSET=" << sets.at(label) << '\n';
    for (const std::size_t n : members) {
      out << n + 1;
      for (const VertexId vertex : nodes_of_tet(mesh, n)) out << ", " << std::uint64_t{vertex} + 1;
      out << '\n';
    }
  }
}

void put_surface(TextOutput& out, const TetMesh& mesh, const MeshSurface& surface) {
  constexpr std::array kSides = {", S3\n", ", S4\n", ", S2\n", ", S1\n"};  // by the corner opposite to the face
  constexpr std::size_t kNumbersEachLine = 16;
  out << "*SURFACE, NAME=" << surface.name << ", TYPE=ELEMENT\n";
  for (const TetFace face : surface.faces) out << std::uint64_t{face.tet} + 1 << kSides[face.opposite];
  out << "*NSET, NSET=" << surface.name;
  std::size_t count = 0;
  for (const VertexId vertex : vertices_of(mesh, surface.faces)) {
    out << (count++ % kNumbersEachLine == 0 ? "\n" : ", ") << std::uint64_t{vertex} + 1;
  }
  out << '\n';
}

// ---- reading

/// The rest of a keyword line.
using Parameters = std::map<std::string, std::string>;

std::string without_blanks(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c != ' ' && c != '\t') result += c;
  }
  return result;
}

std::string_view without_quotes(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// 4 or 10 nodes of a tetrahedron of whatever formulation ("C3D4H", "C3D10M", "DC3D4"); 0 of another element.
std::size_t tet_nodes(std::string_view type) {
  if (type.starts_with("D")) type.remove_prefix(1);
  const std::size_t nodes = type.starts_with("C3D4") ? 4 : type.starts_with("C3D10") ? 10 : 0;
  const bool is_other = type.find_first_of("0123456789", nodes == 10 ? 5 : 4) != std::string_view::npos;
  return is_other ? 0 : nodes;
}

struct ElementSet {
  std::string name;
  std::vector<std::int64_t> members;  ///< numbers of elements of any kind
};

/// A set that stands for a tissue.
struct Tissue {
  const ElementSet* set = nullptr;
  Label label = 0;
};

/// Reads one file from its start to its end.
class AbaqusReader {
 public:
  explicit AbaqusReader(const std::filesystem::path& path) : text_(path), set_members_left_(text_.bytes_left()) {}

  TetMesh read() {
    while (!text_.at_end()) read_line(text_.line());
    finish_element();
    if (is_ours_ && !is_whole_) text_.fail("it ends too early");
    if (mesh_.tets.empty() && !other_type_.empty()) {
      throw InvalidInput(in_quotes(text_.path()) + " has no tetrahedra (C3D4 or C3D10), only elements of type " +
                         other_type_);
    }
    sort_by_number(text_.path(), mesh_);
    set_labels();
    TetMesh mesh = tet_mesh_from(text_.path(), std::move(mesh_));
    mesh.names = std::move(names_);
    return mesh;
  }

 private:
  using Part = void (AbaqusReader::*)();

  void read_line(std::string_view line) {
    const std::string_view shown = trimmed(line);
    if (shown.empty()) return;
    if (shown.starts_with("**")) return read_comment(shown);
    if (shown.front() == '*') return read_keyword(shown);
    if (read_data_ == nullptr) return;
    split_at_commas(shown, fields_);
    (this->*read_data_)();
  }

  void read_comment(std::string_view line) {
    is_ours_ |= line == kFirstLine;
    is_whole_ |= line == kLastLine;
    if (auto comment = label_comment_in(line.substr(2))) {
      add_name(*comment, names_);
      own_labels_[in_small_letters(comment->set)] = comment->label;
    }
  }

  void read_keyword(std::string_view line) {
    struct Named {
      std::string_view name;
      Part begin;
    };
    static constexpr std::array<Named, 8> kKeywords = {{{"NODE", &AbaqusReader::begin_nodes},
                                                        {"ELEMENT", &AbaqusReader::begin_elements},
                                                        {"ELSET", &AbaqusReader::begin_set},
                                                        {"SOLIDSECTION", &AbaqusReader::begin_section},
                                                        {"INSTANCE", &AbaqusReader::begin_instance},
                                                        {"SYSTEM", &AbaqusReader::refuse_system},
                                                        {"INCLUDE", &AbaqusReader::refuse_include},
                                                        {"MANIFEST", &AbaqusReader::refuse_include}}};
    finish_element();
    read_data_ = nullptr;
    const std::string keyword = take_parameters(line);
    const auto found = std::ranges::find(kKeywords, keyword, &Named::name);
    if (found != kKeywords.end()) (this->*found->begin)();
  }

  /// Returns the keyword. A line that ends with a comma goes on in the next.
  std::string take_parameters(std::string_view line) {
    std::string whole(line);
    while (whole.back() == ',' && !text_.at_end()) whole.append(trimmed(text_.line()));
    split_at_commas(whole, fields_);
    parameters_.clear();
    for (const std::string_view field : fields_) {
      const std::size_t equals = std::min(field.find('='), field.size());
      const std::string_view value = field.substr(std::min(equals + 1, field.size()));
      parameters_[in_capitals(without_blanks(field.substr(0, equals)))] = without_quotes(trimmed(value));
    }
    return in_capitals(without_blanks(fields_.front().substr(1)));
  }

  std::string parameter(const std::string& name) const {
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? "" : found->second;
  }

  void refuse_include() { refuse("takes a part from another file, which is not read; put all into one file"); }
  void refuse_system() { refuse("gives nodes in a coordinate system of their own, which is not read"); }

  [[noreturn]] void refuse(const std::string& why) const { throw InvalidInput(in_quotes(text_.path()) + " " + why); }

  void refuse_input_file() {
    if (parameters_.contains("INPUT")) refuse_include();
  }

  // ---- nodes

  void begin_nodes() {
    refuse_input_file();
    const std::string system = in_capitals(parameter("SYSTEM"));
    if (!system.empty() && system != "R") refuse_system();
    read_data_ = &AbaqusReader::read_node;
  }

  void read_node() {
    NumberedPoint point{text_.number_from<std::int64_t>(fields_.front()), {}};
    for (std::size_t axis = 0; axis < 3 && axis + 1 < fields_.size(); ++axis) {
      const std::string_view field = fields_[axis + 1];
      if (!field.empty()) point.place_mm[axis] = text_.number_from<double>(field);
    }
    mesh_.points.push_back(point);
  }

  // The lines of a part's instance say how it is moved and turned.
  void begin_instance() { read_data_ = &AbaqusReader::refuse_move; }
  void refuse_move() { refuse("moves or turns an instance of a part, which is not read"); }

  // ---- elements

  void begin_elements() {
    refuse_input_file();
    const std::string type = in_capitals(parameter("TYPE"));
    set_ = parameters_.contains("ELSET") ? set_of(parameter("ELSET")) : kNoSet;
    if (const std::size_t nodes = tet_nodes(type); nodes > 0) {
      element_.resize(1 + nodes);
      read_data_ = &AbaqusReader::read_element;
    } else if (other_type_.empty()) {
      other_type_ = type.substr(0, 40);
    }
  }

  /// An element may go on in the next line.
  void read_element() {
    for (const std::string_view field : fields_) {
      if (field.empty()) continue;
      element_[element_size_++] = text_.number_from<std::int64_t>(field);
      if (element_size_ < element_.size()) continue;
      mesh_.add(element_[0], std::span(element_).subspan(1), 1);
      if (set_ != kNoSet) add_member(element_[0]);
      element_size_ = 0;
    }
  }

  void finish_element() const {
    if (element_size_ > 0) text_.fail("an element lacks corners");
  }

  // ---- sets

  std::size_t set_of(const std::string& name) {
    const auto [found, is_new] = set_by_name_.try_emplace(in_small_letters(name), sets_.size());
    if (is_new) sets_.push_back({name, {}});
    return found->second;
  }

  /// Whole sets that are taken into others, and ranges, could become far larger than the file.
  void add_member(std::int64_t element) {
    if (set_members_left_-- == 0) refuse("has element sets of more elements than it can hold");
    sets_[set_].members.push_back(element);
  }

  void begin_set() {
    set_ = set_of(parameter("ELSET"));
    read_data_ = parameters_.contains("GENERATE") ? &AbaqusReader::read_range : &AbaqusReader::read_members;
  }

  void read_range() {
    const auto number = [&](std::size_t field, std::int64_t otherwise) {
      const bool is_there = field < fields_.size() && !fields_[field].empty();
      return is_there ? text_.number_from<std::int64_t>(fields_[field]) : otherwise;
    };
    constexpr std::int64_t kMost = std::int64_t{1} << 60;
    const std::int64_t first = number(0, 0), last = number(1, first), step = number(2, 1);
    if (step < 1 || step > kMost || last > kMost) text_.fail("a range of elements has no end");
    for (std::int64_t n = first; n <= last; n += step) add_member(n);
  }

  void read_members() {
    for (const std::string_view field : fields_) {
      if (field.empty()) continue;
      const bool is_number = field.find_first_not_of("0123456789") == std::string_view::npos;
      is_number ? add_member(text_.number_from<std::int64_t>(field)) : add_members_of(field);
    }
  }

  void add_members_of(std::string_view name) {
    const auto found = set_by_name_.find(in_small_letters(without_quotes(name)));
    if (found == set_by_name_.end()) {
      text_.fail("the element set " + in_quotes(name.substr(0, 40)) + " is not there yet");
    }
    const std::vector<std::int64_t> members = sets_[found->second].members;
    for (const std::int64_t member : members) add_member(member);
  }

  void begin_section() { section_sets_.push_back(in_small_letters(parameter("ELSET"))); }

  // ---- labels

  bool has_tets(const ElementSet& set) const {
    return std::ranges::any_of(set.members, [&](std::int64_t member) {
      return std::ranges::binary_search(mesh_.tets, member, {}, &NumberedTet::number);
    });
  }

  std::vector<Tissue> own_tissues() const {
    std::vector<Tissue> tissues;
    for (const ElementSet& set : sets_) {
      const auto own = own_labels_.find(in_small_letters(set.name));
      if (own != own_labels_.end() && has_tets(set)) tissues.push_back({&set, own->second});
    }
    return tissues;
  }

  std::vector<Tissue> other_tissues(bool of_sections) {
    std::vector<Tissue> tissues;
    std::ranges::sort(section_sets_);
    for (const ElementSet& set : sets_) {
      if (of_sections && !std::ranges::binary_search(section_sets_, in_small_letters(set.name))) continue;
      if (has_tets(set)) tissues.push_back({&set, static_cast<Label>(tissues.size() + 1)});
    }
    return tissues;
  }

  std::vector<Tissue> tissues() {
    std::vector<Tissue> found = own_tissues();
    if (!found.empty()) return found;
    found = other_tissues(true);
    if (found.empty()) found = other_tissues(false);
    for (const Tissue& tissue : found) names_[tissue.label].name = tissue.set->name;
    return found;
  }

  /// Of the sets of one element the smallest is the last to say.
  void set_labels() {
    std::vector<Tissue> all = tissues();
    std::set<Label> used;
    for (const Tissue& tissue : all) used.insert(tissue.label);
    Label unused = 1;
    while (used.contains(unused)) ++unused;
    for (NumberedTet& tet : mesh_.tets) tet.label = unused;
    std::ranges::stable_sort(all, std::ranges::greater{}, [](const Tissue& t) { return t.set->members.size(); });
    for (const Tissue& tissue : all) {
      for (const std::int64_t member : tissue.set->members) {
        const auto tet = std::ranges::lower_bound(mesh_.tets, member, {}, &NumberedTet::number);
        if (tet != mesh_.tets.end() && tet->number == member) tet->label = tissue.label;
      }
    }
  }

  static constexpr auto kNoSet = static_cast<std::size_t>(-1);

  TextCursor text_;
  std::vector<std::string_view> fields_;  // of the present line
  Parameters parameters_;                 // of the present keyword
  Part read_data_ = nullptr;              // for the lines below it; null: they say nothing about the mesh
  std::size_t set_ = kNoSet;              // that elements are added to
  std::vector<std::int64_t> element_;     // its number and nodes
  std::size_t element_size_ = 0;
  std::size_t set_members_left_;
  NumberedMesh mesh_;
  std::vector<ElementSet> sets_;
  std::map<std::string, std::size_t> set_by_name_;  // in small letters
  std::vector<std::string> section_sets_;
  std::map<std::string, Label> own_labels_;
  LabelTable names_;
  std::string other_type_;
  bool is_ours_ = false;
  bool is_whole_ = false;
};

}  // namespace

void write_abaqus(const std::filesystem::path& path, const TetMesh& mesh) {
  const auto sets = set_names(mesh, kNameRule);
  TextOutput out;
  out << kFirstLine << '\n';
  for (const LabelComment& comment : label_comments(mesh, sets)) out << "** " << text_of(comment) << '\n';
  put_nodes(out, mesh);
  put_elements(out, mesh, sets);
  for (const MeshSurface& surface : mesh_surfaces(mesh, sets, kNameRule.most_bytes)) put_surface(out, mesh, surface);
  out << kLastLine << '\n';
  write_whole_file(path, out.bytes());
}

TetMesh read_abaqus(const std::filesystem::path& path) { return AbaqusReader(path).read(); }

}  // namespace anatomesh
