// After the "MSC Nastran Quick Reference Guide" (format of bulk data entries; GRID, CTETRA, PSOLID).
#include "io/nastran_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/label_comment.h"
#include "io/number_text.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/set_names.h"
#include "io/text_cursor.h"
#include "io/text_fields.h"
#include "io/text_output.h"

namespace anatomesh {
namespace {

constexpr std::size_t kSmallField = 8;
constexpr std::size_t kLargeField = 16;
constexpr std::string_view kFirstComment = "Anatomesh: tetrahedra of labelled tissues, in mm";
constexpr std::string_view kPointComment = "point ";  // "$ point 4 is 0 0 0.3333333333333333"

double number_in(std::string_view text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The most digits that fit into a large field.
std::string fitting_text(double value, std::chars_format format) {
  for (int digits = 15, excess = 0; digits >= 0; digits -= excess) {
    std::array<char, 400> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format, digits).ptr;
    std::string text(buffer.data(), end);
    if (digits == 0) text.insert(std::min(text.find('e'), text.size()), 1, '.');
    if (const std::size_t zero = text.find("0."); zero == (value < 0 ? 1 : 0) && text.size() > 2 + zero) {
      text.erase(zero, 1);
    }
    if (text.size() <= kLargeField) return text;
    excess = static_cast<int>(text.size() - kLargeField);
  }
  return {};
}

/// Short numbers need not be filled with zeros.
std::string shortened(std::string text) {
  if (text.find('e') != std::string::npos) return text;
  while (text.ends_with('0')) text.pop_back();
  return text == "." || text == "-." ? "0." : text;
}

// ---- writing

void check_numbers(const std::filesystem::path& path, const TetMesh& mesh) {
  const std::string refusal = "cannot write the mesh " + in_quotes(path) + ": ";
  if (std::max(mesh.points_mm.size(), mesh.tets.size()) > kLargestNastranNumber) {
    throw InvalidInput(refusal + "it has " + number_text(mesh.points_mm.size()) + " vertices and " +
                       number_text(mesh.tets.size()) + " tetrahedra, and Nastran holds up to 99999999 of each; take " +
                       "another format");
  }
  if (std::ranges::find(mesh.labels, Label{0}) != mesh.labels.end()) {
    throw InvalidInput(refusal + "it has the label 0, and properties of Nastran begin at 1; take another format");
  }
}

template <typename Value>
void put_field(TextOutput& out, const Value& value, std::size_t width) {
  TextOutput text;
  text << value;
  out << text.bytes() << std::string(width - std::min(width, text.bytes().size()), ' ');
}

/// The exact place, where a large field cannot hold it.
void put_exact_place(TextOutput& out, std::size_t number, const Vec3& place, const std::array<std::string, 3>& fields) {
  const bool is_exact =
      number_in(fields[0]) == place.x && number_in(fields[1]) == place.y && number_in(fields[2]) == place.z;
  if (is_exact) return;
  out << "$ " << kPointComment << number << " is " << place.x << ' ' << place.y << ' ' << place.z << '\n';
}

void put_points(TextOutput& out, const TetMesh& mesh) {
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    const Vec3& place = mesh.points_mm[n];
    const std::array fields = {nastran_real(place.x), nastran_real(place.y), nastran_real(place.z)};
    put_exact_place(out, n + 1, place, fields);
    out << "GRID*   ";
    put_field(out, n + 1, kLargeField);
    put_field(out, ' ', kLargeField);
    put_field(out, fields[0], kLargeField);
    put_field(out, fields[1], kLargeField);
    out << "\n*       " << fields[2] << '\n';
  }
}

void put_tets(TextOutput& out, const TetMesh& mesh) {
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) {
    constexpr std::size_t kFirstLine = 6;  // nodes in it
    out << "CTETRA  ";
    put_field(out, n + 1, kSmallField);
    put_field(out, mesh.labels[n], kSmallField);
    std::size_t count = 0;
    for (const VertexId vertex : nodes_of_tet(mesh, n)) {
      if (count++ == kFirstLine) out << "+\n+       ";
      put_field(out, std::uint64_t{vertex} + 1, kSmallField);
    }
    out << '\n';
  }
}

// ---- reading

/// "1.5-3" and "1.5D-3" are 0.0015.
std::string with_exponent(std::string_view field) {
  std::string text;
  for (const char c : field) {
    const bool is_mark = c == 'D' || c == 'd' || c == 'E' || c == 'e';
    const bool is_sign = (c == '+' || c == '-') && !text.empty() && text.back() != 'e';
    if (is_mark || is_sign) text += 'e';
    if (!is_mark) text += c;
  }
  return text;
}

/// The rest of a line that goes on with the entry of the line before.
bool is_continuation(std::string_view line) {
  return line.front() == '+' || line.front() == '*' || line.front() == ',' ||
         trimmed(line.substr(0, kSmallField)).empty();
}

/// Reads one file from its start to its end.
class NastranReader {
 public:
  explicit NastranReader(const std::filesystem::path& path) : text_(path) {}

  TetMesh read() {
    while (!text_.at_end() && !is_at_end_) read_line(text_.line());
    take_entry();
    if (has_end_ && !is_at_end_) text_.fail("it ends too early");
    TetMesh mesh = tet_mesh_from(text_.path(), std::move(mesh_));
    mesh.names = std::move(names_);
    return mesh;
  }

 private:
  void read_line(std::string_view line) {
    const std::size_t comment = line.find('$');
    if (comment != std::string_view::npos) read_comment(trimmed(line.substr(comment + 1)));
    line = line.substr(0, comment);
    if (trimmed(line).empty()) return;
    if (!is_continuation(line)) begin_entry(line);
    add_fields(line);
  }

  void read_comment(std::string_view comment) {
    has_end_ |= comment == kFirstComment;
    if (const auto label = label_comment_in(comment)) return add_name(*label, names_);
    if (!comment.starts_with(kPointComment)) return;
    split_at_spaces(comment.substr(kPointComment.size()), words_);  // "4 is 0 0 0.3333333333333333"
    if (words_.size() != 5 || words_[1] != "is") return;
    told_place_ = {text_.number_from<std::int64_t>(words_[0]),
                   {text_.number_from<double>(words_[2]), text_.number_from<double>(words_[3]),
                    text_.number_from<double>(words_[4])}};
  }

  void begin_entry(std::string_view line) {
    take_entry();
    entry_.clear();
    exact_ = std::exchange(told_place_, std::nullopt);
    split_at_spaces(line, words_);
    const std::string first = in_capitals(words_.front());
    is_at_end_ = first == "ENDDATA";
    if (first == "INCLUDE") refuse("takes a part from another file, which is not read; put all into one file");
    if (first != "BEGIN") return;
    has_end_ = true;
    mesh_ = {};  // what comes before is no bulk data
  }

  /// Fields of 8 or 16 columns, or between commas; the last of a line, which continuations are told by, is left out.
  void add_fields(std::string_view line) {
    constexpr std::size_t kColumns = 72;
    const bool is_free = line.find(',') != std::string_view::npos;
    if (is_free) split_at_commas(line, words_);
    const std::string_view first = is_free ? words_.front() : trimmed(line.substr(0, kSmallField));
    const std::size_t width = first.find('*') != std::string_view::npos ? kLargeField : kSmallField;
    const std::size_t most = (kColumns - kSmallField) / width;
    if (entry_.empty()) entry_.push_back(first);
    entry_.resize(1 + (entry_.size() - 1 + most - 1) / most * most);
    for (std::size_t n = 0; n < most; ++n) {
      const std::size_t at = kSmallField + n * width;
      if (is_free ? n + 1 >= words_.size() : at >= line.size()) return;
      entry_.push_back(is_free ? words_[n + 1] : trimmed(line.substr(at, width)));
    }
  }

  void take_entry() {
    struct Named {
      std::string_view name;
      void (NastranReader::*take)();
    };
    static constexpr std::array<Named, 3> kEntries = {{{"GRID", &NastranReader::take_point},
                                                       {"CTETRA", &NastranReader::take_tet},
                                                       {"GRDSET", &NastranReader::take_point_defaults}}};
    if (entry_.empty()) return;
    std::string name = in_capitals(entry_.front());
    if (name.ends_with('*')) name.pop_back();
    const auto found = std::ranges::find(kEntries, name, &Named::name);
    if (found != kEntries.end()) (this->*found->take)();
  }

  std::string_view field(std::size_t n) const { return n < entry_.size() ? entry_[n] : std::string_view(); }
  std::int64_t whole_number(std::size_t n) const { return text_.number_from<std::int64_t>(field(n)); }
  double real(std::size_t n) const { return field(n).empty() ? 0 : text_.number_from<double>(with_exponent(field(n))); }

  [[noreturn]] void refuse(const std::string& why) const { throw InvalidInput(in_quotes(text_.path()) + " " + why); }

  void refuse_system(std::size_t n) const {
    if (field(n).empty() || field(n) == "0") return;
    refuse("has points in the coordinate system " + std::string(field(n)) + ", which is not read; use the basic one");
  }

  void take_point_defaults() { refuse_system(2); }

  void take_point() {
    refuse_system(2);
    NumberedPoint point{whole_number(1), {real(3), real(4), real(5)}};
    if (exact_ && exact_->number == point.number) take_exact_place(point.place_mm);
    mesh_.points.push_back(point);
  }

  /// A coordinate that somebody has changed since is not the rounded one any more.
  void take_exact_place(Vec3& place) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double exact = exact_->place_mm[axis];
      if (number_in(nastran_real(exact)) == place[axis]) place[axis] = exact;
    }
  }

  /// Nodes of the present tetrahedron, which may leave out edge nodes.
  std::size_t node_count(std::int64_t number) const {
    constexpr std::size_t kFirst = 7, kCount = 6;  // of the fields of edge nodes
    std::size_t found = 0;
    for (std::size_t n = kFirst; n < entry_.size(); ++n) found += !entry_[n].empty();
    if (found > 0 && found < kCount) {
      refuse("has " + number_text(found) + " edge nodes of tetrahedron " + number_text(number) +
             "; 0 or 6 can be read");
    }
    return 4 + found;
  }

  void take_tet() {
    const std::int64_t number = whole_number(1), property = field(2).empty() ? number : whole_number(2);
    if (property < 0 || property > std::numeric_limits<Label>::max()) {
      refuse("has the property " + number_text(property) + "; properties must be whole numbers from 0 to 4294967295");
    }
    std::vector<std::int64_t> nodes(std::min<std::size_t>(node_count(number), 10));
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = whole_number(n + 3);
    mesh_.add(number, nodes, static_cast<Label>(property));
  }

  TextCursor text_;
  std::vector<std::string_view> words_;      // of the present line
  std::vector<std::string_view> entry_;      // the fields of its lines so far
  std::optional<NumberedPoint> exact_;       // the place told by a comment before the entry
  std::optional<NumberedPoint> told_place_;  // the same for the next one
  NumberedMesh mesh_;
  LabelTable names_;
  bool has_end_ = false;  // but for files that are to be included in others
  bool is_at_end_ = false;
};

}  // namespace

std::string nastran_real(double value) {
  // Between these, exponents cost more digits than they save.
  constexpr double kLeast = 1e-3, kMost = 1e13;
  std::string best = shortened(fitting_text(value, std::chars_format::fixed));
  if (value == 0 || (std::abs(value) >= kLeast && std::abs(value) < kMost)) return best;
  std::string scientific = fitting_text(value, std::chars_format::scientific);
  const auto error = [&](const std::string& text) { return std::abs(number_in(text) - value); };
  if (best.empty() || error(scientific) < error(best)) best = std::move(scientific);
  std::ranges::replace(best, 'e', 'E');
  return best;
}

void write_nastran(const std::filesystem::path& path, const TetMesh& mesh) {
  check_numbers(path, mesh);
  const auto sets = set_names(mesh, {.identifier = true});
  TextOutput out;
  out << "$ " << kFirstComment << '\n';
  for (const LabelComment& comment : label_comments(mesh, sets)) out << "$ " << text_of(comment) << '\n';
  out << "BEGIN BULK\n";
  for (const auto& [label, name] : sets) {
    out << "PSOLID  ";
    put_field(out, label, kSmallField);
    out << label << '\n';
  }
  put_points(out, mesh);
  put_tets(out, mesh);
  out << "ENDDATA\n";
  write_whole_file(path, out.bytes());
}

TetMesh read_nastran(const std::filesystem::path& path) { return NastranReader(path).read(); }

}  // namespace anatomesh
