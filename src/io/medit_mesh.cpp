// After P. Frey, "MEDIT: an interactive mesh visualization software", INRIA RT-0253 (2001), the part on the format.
#include "io/medit_mesh.h"

#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "anatomesh/errors.h"
#include "io/element_nodes.h"
#include "io/label_comment.h"
#include "io/label_values.h"
#include "io/mesh_groups.h"
#include "io/number_text.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/text_cursor.h"
#include "io/text_output.h"

namespace anatomesh {
namespace {

constexpr std::size_t kMostNameBytes = 120;  // Gmsh reads lines of 255
constexpr std::string_view kLabelComment = "label ";

// ---- writing

void put_names(TextOutput& out, const TetMesh& mesh, const MeshGroups& groups) {
  for (const LabelComment& tissue : label_comments(mesh, groups.tissues)) {
    if (!tissue.name.empty()) out << "# " << kLabelComment << tissue.label << ' ' << tissue.name << '\n';
  }
  for (const SurfaceGroup& group : groups.surfaces) out << "# surface " << group.tag << ' ' << group.name << '\n';
}

void put_element(TextOutput& out, const ElementNodes& nodes, Label reference) {
  for (const VertexId vertex : nodes) out << std::size_t{vertex} + 1 << ' ';
  out << reference << '\n';
}

void put_triangles(TextOutput& out, const TetMesh& mesh, const MeshGroups& groups) {
  std::size_t count = 0;
  for (const SurfaceGroup& group : groups.surfaces) count += group.between.faces.size();
  out << (is_quadratic(mesh) ? "\nTrianglesP2\n" : "\nTriangles\n") << count << '\n';
  for (const SurfaceGroup& group : groups.surfaces) {
    for (const TetFace face : group.between.faces) put_element(out, nodes_of_face(mesh, face), group.tag);
  }
}

std::string medit_text(const TetMesh& mesh) {
  const MeshGroups groups = mesh_groups(mesh, kMostNameBytes);
  TextOutput out;
  out << "MeshVersionFormatted 2\nDimension 3\n";
  put_names(out, mesh, groups);
  out << "\nVertices\n" << mesh.points_mm.size() << '\n';
  for (const Vec3& point : mesh.points_mm) out << point[0] << ' ' << point[1] << ' ' << point[2] << " 0\n";
  put_triangles(out, mesh, groups);
  out << (is_quadratic(mesh) ? "\nTetrahedraP2\n" : "\nTetrahedra\n") << mesh.tets.size() << '\n';
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) put_element(out, nodes_of_tet(mesh, n), mesh.labels[n]);
  out << "\nEnd\n";
  return out.bytes();
}

// ---- reading

/// Reads one file from its start to its end.
class MeditReader {
 public:
  explicit MeditReader(const std::filesystem::path& path) : text_(path) {}

  TetMesh read() {
    if (keyword() != "MeshVersionFormatted") text_.fail("it does not begin with MeshVersionFormatted");
    text_.number<int>();
    for (std::string section = keyword(); section != "End";) section = read_section(section);
    TetMesh mesh = tet_mesh_from(text_.path(), std::move(mesh_));
    mesh.names = std::move(names_);
    return mesh;
  }

 private:
  /// The next word that is no comment.
  std::string keyword() {
    std::string_view word = text_.word();
    for (; word.starts_with('#'); word = text_.word()) read_comment(std::string(word.substr(1)));
    if (word.empty()) text_.fail("it has no End");
    return std::string(word);
  }

  void read_comment(std::string comment) {
    if (!text_.at_line_end()) comment.append(1, ' ').append(text_.line());
    std::string_view rest = trimmed(comment);
    if (!rest.starts_with(kLabelComment)) return;
    rest.remove_prefix(kLabelComment.size());
    Label label = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), label);
    const std::string_view name = trimmed(rest.substr(static_cast<std::size_t>(end - rest.data())));
    if (error == std::errc() && !name.empty()) names_[label].name = name;
  }

  /// Returns the keyword of the next one.
  std::string read_section(const std::string& name) {
    struct Named {
      std::string_view name;
      void (MeditReader::*read)();
    };
    static constexpr std::array<Named, 4> kSections = {{{"Dimension", &MeditReader::dimension},
                                                        {"Vertices", &MeditReader::vertices},
                                                        {"Tetrahedra", &MeditReader::tetrahedra<4>},
                                                        {"TetrahedraP2", &MeditReader::tetrahedra<10>}}};
    for (const Named& section : kSections) {
      if (section.name != name) continue;
      (this->*section.read)();
      return keyword();
    }
    return skipped_section(name);
  }

  /// Other sections are numbers up to the next word.
  std::string skipped_section(const std::string& name) {
    if (std::isalpha(static_cast<unsigned char>(name.front())) == 0) {
      text_.fail(in_quotes(name.substr(0, 40)) + " stands where a section should begin");
    }
    for (;;) {
      std::string next = keyword();
      if (std::isalpha(static_cast<unsigned char>(next.front())) != 0) return next;
    }
  }

  void dimension() {
    const int dimension = text_.number<int>();
    if (dimension == 3) return;
    throw InvalidInput(in_quotes(text_.path()) + " has the dimension " + number_text(dimension) +
                       "; meshes of tetrahedra have 3");
  }

  void vertices() {
    for (std::size_t left = text_.count_of(8); left > 0; --left) {
      NumberedPoint point{static_cast<std::int64_t>(mesh_.points.size()) + 1, {}};
      for (std::size_t axis = 0; axis < 3; ++axis) point.place_mm[axis] = text_.number<double>();
      text_.number<std::int64_t>();
      mesh_.points.push_back(point);
    }
  }

  template <std::size_t kNodes>
  void tetrahedra() {
    for (std::size_t left = text_.count_of(2 * kNodes + 2); left > 0; --left) {
      const auto number = static_cast<std::int64_t>(mesh_.tets.size()) + 1;
      std::array<std::int64_t, kNodes> nodes;
      for (std::int64_t& node : nodes) node = text_.number<std::int64_t>();
      const auto reference = text_.number<std::int64_t>();
      if (!is_label(reference)) {
        throw InvalidInput("tetrahedron " + number_text(number) + " of " + in_quotes(text_.path()) +
                           " has the reference " + number_text(reference) + "; " + kLabelRule);
      }
      mesh_.add(number, nodes, static_cast<Label>(reference));
    }
  }

  TextCursor text_;
  NumberedMesh mesh_;
  LabelTable names_;
};

}  // namespace

void write_medit(const std::filesystem::path& path, const TetMesh& mesh) { write_whole_file(path, medit_text(mesh)); }

TetMesh read_medit(const std::filesystem::path& path) { return MeditReader(path).read(); }

}  // namespace anatomesh
