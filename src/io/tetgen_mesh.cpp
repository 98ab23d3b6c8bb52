// After H. Si, "TetGen, a Quality Tetrahedral Mesh Generator", user's manual, version 1.5: file formats.
#include "io/tetgen_mesh.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/label_comment.h"
#include "io/label_values.h"
#include "io/number_text.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/set_names.h"
#include "io/text_cursor.h"
#include "io/text_fields.h"
#include "io/text_output.h"
#include "io/whole_files.h"

namespace anatomesh {
namespace {

namespace fs = std::filesystem;

constexpr EdgeNodeOrder kTetgenOrder = {5, 3, 0, 1, 4, 2};

/// Both files, whichever was named. The extension that was named keeps its spelling; the other one is in small letters,
/// or in capitals if that is what the first one is in.
struct Pair {
  fs::path nodes, elements;

  explicit Pair(const fs::path& named) : nodes(named), elements(named) {
    const bool in_big = named.extension().string() == in_capitals(named.extension().string());
    if (file_extension(named) == ".node") {
      elements.replace_extension(in_big ? ".ELE" : ".ele");
    } else {
      nodes.replace_extension(in_big ? ".NODE" : ".node");
    }
  }
};

std::string node_text(const TetMesh& mesh) {
  TextOutput out;
  out << mesh.points_mm.size() << " 3 0 0\n";
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    const Vec3& point = mesh.points_mm[n];
    out << n + 1 << ' ' << point.x << ' ' << point.y << ' ' << point.z << '\n';
  }
  return out.bytes();
}

std::string element_text(const TetMesh& mesh) {
  TextOutput out;
  for (const LabelComment& comment : label_comments(mesh, set_names(mesh, {.identifier = true}))) {
    out << "# " << text_of(comment) << '\n';
  }
  out << mesh.tets.size() << (is_quadratic(mesh) ? " 10 1\n" : " 4 1\n");
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) {
    out << n + 1;
    for (const VertexId vertex : nodes_of_tet(mesh, n, kTetgenOrder)) out << ' ' << std::uint64_t{vertex} + 1;
    out << ' ' << mesh.labels[n] << '\n';
  }
  return out.bytes();
}

/// The lines of a file that hold words.
class WordLines {
 public:
  explicit WordLines(const fs::path& path) : text_(path) {}

  /// The words of the next line; none may be missing. Throws IoError.
  void next(std::size_t least_words) {
    do {
      if (text_.at_end()) text_.fail("it ends too early");
      const std::string_view line = text_.line();
      const std::size_t comment = line.find('#');
      if (comment != std::string_view::npos) {
        if (auto label = label_comment_in(line.substr(comment + 1))) add_name(*label, names_);
      }
      split_at_spaces(line.substr(0, comment), words_);
    } while (words_.empty());
    if (words_.size() < least_words) {
      text_.fail("it has " + number_text(words_.size()) + " of at least " + number_text(least_words) + " numbers");
    }
  }

  std::size_t size() const { return words_.size(); }
  template <typename Number>
  Number number(std::size_t n) const {
    return text_.number_from<Number>(words_[n]);
  }

  const fs::path& path() const { return text_.path(); }
  LabelTable& names() { return names_; }

 private:
  TextCursor text_;
  std::vector<std::string_view> words_;  // of the present line
  LabelTable names_;
};

std::vector<NumberedPoint> read_points(const fs::path& path) {
  WordLines lines(path);
  lines.next(1);
  const auto count = lines.number<std::uint32_t>(0);
  if (lines.size() > 1 && lines.number<int>(1) != 3) {
    throw InvalidInput(in_quotes(path) + " has points of " + number_text(lines.number<int>(1)) +
                       " dimensions; 3 are needed");
  }
  std::vector<NumberedPoint> points;  // grows with what is there, whatever the count says
  while (points.size() < count) {
    lines.next(4);
    points.push_back(
        {lines.number<std::int64_t>(0), {lines.number<double>(1), lines.number<double>(2), lines.number<double>(3)}});
  }
  return points;
}

/// In the first word behind the nodes.
Label label_from(const WordLines& line, std::size_t word) {
  const auto value = line.number<double>(word);
  if (is_label(value)) return static_cast<Label>(value);
  throw InvalidInput("tetrahedron " + number_text(line.number<std::int64_t>(0)) + " of " + in_quotes(line.path()) +
                     " has the region attribute " + number_text(value) + "; " + kLabelRule);
}

void read_tets(WordLines& lines, NumberedMesh& mesh) {
  lines.next(1);
  const auto count = lines.number<std::uint32_t>(0);
  const std::size_t nodes_each = lines.size() > 1 ? lines.number<std::uint32_t>(1) : 4;
  const bool has_attribute = lines.size() > 2 && lines.number<std::uint32_t>(2) > 0;
  if (nodes_each != 4 && nodes_each != 10) {
    throw InvalidInput(in_quotes(lines.path()) + " has tetrahedra of " + number_text(nodes_each) +
                       " nodes; 4 or 10 are needed");
  }
  std::vector<std::int64_t> nodes(nodes_each);
  while (mesh.tets.size() < count) {
    lines.next(nodes_each + (has_attribute ? 2 : 1));
    for (std::size_t n = 0; n < nodes_each; ++n) nodes[n] = lines.number<std::int64_t>(n + 1);
    const Label label = has_attribute ? label_from(lines, nodes_each + 1) : 1;
    mesh.add(lines.number<std::int64_t>(0), nodes, label, kTetgenOrder);
  }
}

}  // namespace

void write_tetgen(const fs::path& path, const TetMesh& mesh) {
  const Pair pair(path);
  write_whole_files({{pair.nodes, node_text(mesh)}, {pair.elements, element_text(mesh)}});
}

TetMesh read_tetgen(const fs::path& path) {
  const Pair pair(path);
  for (const fs::path& file : {pair.nodes, pair.elements}) {
    if (fs::exists(file)) continue;
    throw IoError("cannot read the mesh " + in_quotes(path) + ": there is no file " + in_quotes(file) + " beside it");
  }
  WordLines lines(pair.elements);
  NumberedMesh numbered;
  read_tets(lines, numbered);
  numbered.points = read_points(pair.nodes);
  TetMesh mesh = tet_mesh_from(path, std::move(numbered));
  mesh.names = std::move(lines.names());
  return mesh;
}

}  // namespace anatomesh
