// After the "FEBio User's Manual", version 4: free format input (Material, Mesh and MeshDomains sections).
#include "io/febio_mesh.h"

#include <array>
#include <cstdint>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/options.h"
#include "io/cell_arrays.h"
#include "io/element_nodes.h"
#include "io/label_comment.h"
#include "io/mesh_surfaces.h"
#include "io/numbered_mesh.h"
#include "io/output_file.h"
#include "io/set_names.h"
#include "io/text_cursor.h"
#include "io/text_fields.h"
#include "io/text_output.h"

namespace anatomesh {
namespace {

// FEBio takes "a.b" for b in the part a, so that names are identifiers.
constexpr NameRule kNameRule = {.identifier = true};

struct Escape {
  char plain;
  std::string_view escaped;
};

/// In comments, which "--" would end.
constexpr std::array<Escape, 2> kEscapes = {{{'&', "&amp;"}, {'-', "&#45;"}}};

// ---- writing

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    std::string_view shown(&c, 1);
    for (const Escape& escape : kEscapes) {
      if (c == escape.plain) shown = escape.escaped;
    }
    result.append(shown);
  }
  return result;
}

void put_materials(TextOutput& out, const std::vector<LabelComment>& tissues) {
  constexpr double kPaInMpa = 1e-6;
  const Material material;
  out << "  <Material>\n    <!--lengths in mm, stiffnesses in MPa: all tissues as brain until you say otherwise-->\n";
  for (std::size_t n = 0; n < tissues.size(); ++n) {
    out << "    <!--" << escaped(text_of(tissues[n])) << "-->\n";
    out << "    <material id=\"" << n + 1 << "\" name=\"" << tissues[n].set << "\" type=\"neo-Hookean\">\n";
    out << "      <E>" << material.young_modulus_pa * kPaInMpa << "</E>\n";
    out << "      <v>" << material.poisson_ratio << "</v>\n    </material>\n";
  }
  out << "  </Material>\n";
}

/// Numbers from 1 of vertices, between commas.
template <typename Vertices>
void put_vertices(TextOutput& out, const Vertices& vertices) {
  bool is_first = true;
  for (const VertexId vertex : vertices) {
    if (!std::exchange(is_first, false)) out << ',';
    out << std::uint64_t{vertex} + 1;
  }
}

void put_nodes(TextOutput& out, const TetMesh& mesh) {
  out << "    <Nodes name=\"nodes\">\n";
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    const Vec3& point = mesh.points_mm[n];
    out << "      <node id=\"" << n + 1 << "\">" << point.x << ',' << point.y << ',' << point.z << "</node>\n";
  }
  out << "    </Nodes>\n";
}

void put_elements(TextOutput& out, const TetMesh& mesh, const std::vector<LabelComment>& tissues) {
  std::map<Label, std::vector<std::size_t>> tets;
  for (std::size_t n = 0; n < mesh.tets.size(); ++n) tets[mesh.labels[n]].push_back(n);
  for (const LabelComment& tissue : tissues) {
    out << "    <Elements type=\"" << (is_quadratic(mesh) ? "tet10" : "tet4") << "\" name=\"" << tissue.set << "\">\n";
    for (const std::size_t n : tets[tissue.label]) {
      out << "      <elem id=\"" << n + 1 << "\">";
      put_vertices(out, nodes_of_tet(mesh, n));
      out << "</elem>\n";
    }
    out << "    </Elements>\n";
  }
}

void put_surface(TextOutput& out, const TetMesh& mesh, const MeshSurface& surface) {
  const char* facet = is_quadratic(mesh) ? "tri6" : "tri3";
  out << "    <Surface name=\"" << surface.name << "\">\n";
  for (std::size_t n = 0; n < surface.faces.size(); ++n) {
    out << "      <" << facet << " id=\"" << n + 1 << "\">";
    put_vertices(out, nodes_of_face(mesh, surface.faces[n]));
    out << "</" << facet << ">\n";
  }
  out << "    </Surface>\n    <NodeSet name=\"" << surface.name << "\">";
  put_vertices(out, vertices_of(mesh, surface.faces));
  out << "</NodeSet>\n";
}

// ---- reading

std::string without_escapes(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    char c = text.front();
    std::size_t size = 1;
    for (const Escape& escape : kEscapes) {
      if (!text.starts_with(escape.escaped)) continue;
      c = escape.plain;
      size = escape.escaped.size();
    }
    result += c;
    text.remove_prefix(size);
  }
  return result;
}

/// Reads one model.
class FebioReader {
 public:
  explicit FebioReader(const std::filesystem::path& path) : text_(path) {
    const std::string_view bytes = text_.take(text_.bytes_left());
    const auto parsed = document_.load_buffer(bytes.data(), bytes.size(), pugi::parse_default | pugi::parse_comments);
    if (!parsed) throw_damaged(path, std::string("as XML, ").append(parsed.description()));
  }

  TetMesh read() {
    const pugi::xml_node model = document_.child("febio_spec");
    if (!model) throw_damaged(text_.path(), "it has no febio_spec");
    read_comments(model.child("Material"));
    for (const char* section : {"Mesh", "Geometry"}) read_mesh(model.child(section));
    TetMesh mesh = tet_mesh_from(text_.path(), std::move(mesh_));
    mesh.names = std::move(names_);
    return mesh;
  }

 private:
  void read_comments(pugi::xml_node materials) {
    for (const pugi::xml_node node : materials.children()) {
      if (node.type() != pugi::node_comment) continue;
      const auto comment = label_comment_in(without_escapes(node.value()));
      if (!comment) continue;
      add_name(*comment, names_);
      own_labels_[comment->set] = comment->label;
    }
  }

  void read_mesh(pugi::xml_node section) {
    if (section.attribute("from")) {
      throw InvalidInput(in_quotes(text_.path()) + " takes its mesh from the file '" +
                         section.attribute("from").value() + "', which is not read; name that file");
    }
    for (const pugi::xml_node nodes : section.children("Nodes")) read_nodes(nodes);
    for (const pugi::xml_node elements : section.children("Elements")) {
      const std::string_view type = elements.attribute("type").value();
      if (type == "tet4") read_elements<4>(elements);
      if (type == "tet10") read_elements<10>(elements);
    }
  }

  void read_nodes(pugi::xml_node nodes) {
    for (const pugi::xml_node node : nodes.children("node")) {
      const auto place = numbers_of<double, 3>(node);
      mesh_.points.push_back({id_of(node), {place[0], place[1], place[2]}});
    }
  }

  template <std::size_t kNodes>
  void read_elements(pugi::xml_node elements) {
    const Label label = label_of(elements.attribute("name").value());
    for (const pugi::xml_node element : elements.children("elem")) {
      mesh_.add(id_of(element), numbers_of<std::int64_t, kNodes>(element), label);
    }
  }

  Label label_of(const std::string& part) {
    ++parts_;
    if (!own_labels_.empty()) {
      const auto own = own_labels_.find(part);
      if (own == own_labels_.end()) {
        throw InvalidInput(in_quotes(text_.path()) + " has the part '" + part +
                           "' and no comment with its label; add one, or take the others out");
      }
      return own->second;
    }
    if (!part.empty()) names_[parts_].name = part;
    return parts_;
  }

  std::int64_t id_of(pugi::xml_node node) const { return number<std::int64_t>(node, node.attribute("id").value()); }

  template <typename Number, std::size_t count>
  std::array<Number, count> numbers_of(pugi::xml_node node) {
    split_at_commas(node.child_value(), fields_);
    if (fields_.size() != count) fail(node, node.child_value());
    std::array<Number, count> numbers;
    for (std::size_t n = 0; n < count; ++n) numbers[n] = number<Number>(node, fields_[n]);
    return numbers;
  }

  template <typename Number>
  Number number(pugi::xml_node node, std::string_view text) const {
    Number value{};
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) fail(node, text);
    return value;
  }

  [[noreturn]] void fail(pugi::xml_node node, std::string_view text) const {
    throw_damaged(text_.path(), "the " + std::string(node.name()) + " '" + node.attribute("id").value() + "' has '" +
                                    std::string(text.substr(0, 40)) + "' where its numbers should be");
  }

  TextCursor text_;
  pugi::xml_document document_;
  std::vector<std::string_view> fields_;
  NumberedMesh mesh_;
  std::map<std::string, Label> own_labels_;
  LabelTable names_;
  Label parts_ = 0;
};

}  // namespace

void write_febio(const std::filesystem::path& path, const TetMesh& mesh) {
  const auto sets = set_names(mesh, kNameRule);
  const auto tissues = label_comments(mesh, sets);
  TextOutput out;
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n  <Module type=\"solid\"/>\n";
  put_materials(out, tissues);
  out << "  <Mesh>\n";
  put_nodes(out, mesh);
  put_elements(out, mesh, tissues);
  for (const MeshSurface& surface : mesh_surfaces(mesh, sets, kNameRule.most_bytes)) put_surface(out, mesh, surface);
  out << "  </Mesh>\n  <MeshDomains>\n";
  for (const LabelComment& tissue : tissues) {
    out << "    <SolidDomain name=\"" << tissue.set << "\" mat=\"" << tissue.set << "\"/>\n";
  }
  out << "  </MeshDomains>\n</febio_spec>\n";
  write_whole_file(path, out.bytes());
}

TetMesh read_febio(const std::filesystem::path& path) { return FebioReader(path).read(); }

}  // namespace anatomesh
