// After "XDMF Model and Format" (https://www.xdmf.org/index.php/XDMF_Model_and_Format), version 3.
#include <algorithm>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/interfaces.h"
#include "io/element_nodes.h"
#include "io/hdf5_file.h"
#include "io/interface_names.h"
#include "io/label_colour.h"
#include "io/number_text.h"
#include "io/set_names.h"
#include "io/surface.h"
#include "io/whole_files.h"
#include "io/xdmf_mesh.h"

namespace anatomesh {
namespace {

/// Numbers in memory, in rows; a plain list where there is one column.
struct Table {
  NumberType type = NumberType::u8;
  const void* values = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 1;
};

Table list_of(const std::vector<std::uint32_t>& values) { return {NumberType::u32, values.data(), values.size()}; }

std::string shape_text(const Table& table) {
  std::string text = number_text(table.rows);
  if (table.columns > 1) text.append(" ").append(number_text(table.columns));
  return text;
}

/// Nodes of a kind of cells, as 32-bit numbers where they fit.
class Cells {
 public:
  /// nodes_of(n): those of cell n.
  template <typename NodesOf>
  Cells(std::size_t count, std::size_t nodes_each, std::size_t point_count, const NodesOf& nodes_of) {
    const bool is_wide = point_count > std::numeric_limits<std::int32_t>::max();
    is_wide ? wide_.reserve(count * nodes_each) : narrow_.reserve(count * nodes_each);
    for (std::size_t n = 0; n < count; ++n) {
      for (const VertexId node : nodes_of(n))
        is_wide ? wide_.push_back(node) : narrow_.push_back(static_cast<std::int32_t>(node));
    }
    table_ = is_wide ? Table{NumberType::i64, wide_.data(), count, nodes_each}
                     : Table{NumberType::i32, narrow_.data(), count, nodes_each};
  }
  const Table& table() const { return table_; }

 private:
  std::vector<std::int64_t> wide_;
  std::vector<std::int32_t> narrow_;
  Table table_;
};

/// One grid: an .xdmf file and the .h5 file of its name.
class GridFiles {
 public:
  GridFiles(std::filesystem::path path, const char* grid_name) : path_(std::move(path)) {
    document_.append_child(pugi::node_declaration).append_attribute("version") = "1.0";
    pugi::xml_node root = document_.append_child("Xdmf");
    root.append_attribute("Version") = "3.0";
    grid_ = root.append_child("Domain").append_child("Grid");
    grid_.append_attribute("Name") = grid_name;
    grid_.append_attribute("GridType") = "Uniform";
  }

  std::filesystem::path h5_path() const { return std::filesystem::path(path_).replace_extension(".h5"); }
  Hdf5Image& h5() { return h5_; }

  void set_topology(const char* type, const std::string& dataset, const Table& corners) {
    pugi::xml_node topology = grid_.append_child("Topology");
    topology.append_attribute("TopologyType") = type;
    topology.append_attribute("NumberOfElements") = number_text(corners.rows).c_str();
    topology.append_attribute("NodesPerElement") = number_text(corners.columns).c_str();
    add_item(topology, dataset, corners);
  }

  /// The points, which lie in the .h5 file of other files where these are given.
  void set_geometry(const std::string& dataset, const Table& points, const GridFiles* stored_by = nullptr) {
    pugi::xml_node geometry = grid_.append_child("Geometry");
    geometry.append_attribute("GeometryType") = "XYZ";
    stored_by == nullptr ? add_item(geometry, dataset, points) : refer(geometry, *stored_by, dataset, points);
  }

  void add_cell_attribute(const char* name, const std::string& dataset, const Table& values) {
    pugi::xml_node attribute = grid_.append_child("Attribute");
    attribute.append_attribute("Name") = name;
    attribute.append_attribute("AttributeType") = "Scalar";
    attribute.append_attribute("Center") = "Cell";
    add_item(attribute, dataset, values);
  }

  /// The <map> elements of this document, as a text inside the text.
  void add_information(const char* name, const pugi::xml_document& maps) {
    std::ostringstream text;
    maps.save(text, "", pugi::format_raw | pugi::format_no_declaration);
    pugi::xml_node information = grid_.append_child("Information");
    information.append_attribute("Name") = name;
    information.append_attribute("Value") = "";
    information.append_child(pugi::node_cdata).set_value(text.str().c_str());
  }

  void take_bytes(std::vector<FileBytes>& files) const {
    std::ostringstream text;
    document_.save(text, " ");
    files.push_back({h5_path(), h5_.bytes()});
    files.push_back({path_, text.str()});
  }

 private:
  void add_item(pugi::xml_node parent, const std::string& dataset, const Table& table) {
    h5_.add(dataset, table.type, table.values, table.rows, table.columns);
    refer(parent, *this, dataset, table);
  }

  static void refer(pugi::xml_node parent, const GridFiles& to, const std::string& dataset, const Table& table) {
    const bool is_real = table.type == NumberType::f64;
    pugi::xml_node item = parent.append_child("DataItem");
    item.append_attribute("NumberType") = is_real ? "Float" : table.type == NumberType::u32 ? "UInt" : "Int";
    item.append_attribute("Precision") = number_text(bytes_of(table.type)).c_str();
    item.append_attribute("Dimensions") = shape_text(table).c_str();
    item.append_attribute("Format") = "HDF";
    item.text() = (to.h5_path().filename().string() + ":" + dataset).c_str();
  }

  std::filesystem::path path_;
  pugi::xml_document document_;
  pugi::xml_node grid_;
  Hdf5Image h5_;
};

pugi::xml_node append_map(pugi::xml_node parent, const std::string& name, const char* dimension, std::uint32_t value) {
  pugi::xml_node map = parent.append_child("map");
  map.append_attribute("key") = name.c_str();
  map.append_attribute("dim") = dimension;
  map.text() = number_text(value).c_str();
  return map;
}

// ---- the tetrahedra

void add_label_table(GridFiles& to, const LabelTable& names) {
  if (names.empty()) return;
  pugi::xml_document maps;
  pugi::xml_node main = maps.append_child("main");
  std::vector<Label> values;
  std::vector<std::string> texts;
  std::vector<std::uint8_t> colours;
  for (const auto& [label, entry] : names) {
    pugi::xml_node map = append_map(main, entry.name, "3", label);
    if (entry.colour) map.append_attribute("colour") = colour_text(*entry.colour).c_str();
    values.push_back(label);
    texts.push_back(entry.name);
    if (entry.colour) colours.insert(colours.end(), entry.colour->begin(), entry.colour->end());
  }
  to.add_information("labels", maps);
  to.h5().add("/labels/values", NumberType::u32, values.data(), values.size(), 1);
  to.h5().add("/labels/names", texts);
  if (colours.size() == 3 * values.size()) {
    to.h5().add("/labels/colours", NumberType::u8, colours.data(), values.size(), 3);
  }
}

constexpr const char* kPoints = "/mesh/points";

Table points_of(const TetMesh& mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {NumberType::f64, mesh.points_mm.data(), mesh.points_mm.size(), 3};
}

void add_tets(GridFiles& to, const TetMesh& mesh) {
  const Cells cells(mesh.tets.size(), nodes_per_tet(mesh), mesh.points_mm.size(),
                    [&](std::size_t n) { return nodes_of_tet(mesh, n); });
  to.set_geometry(kPoints, points_of(mesh));
  to.set_topology(is_quadratic(mesh) ? "Tetrahedron_10" : "Tetrahedron", "/mesh/tetrahedra", cells.table());
  to.add_cell_attribute("label", "/mesh/label", list_of(mesh.labels));
  add_label_table(to, mesh.names);
}

// ---- the facets

/// The faces of all interfaces; one value a face.
struct Facets {
  std::vector<TetFace> faces;
  std::vector<std::uint32_t> interface, inside, outside;
};

Facets facets_of(const std::vector<Interface>& interfaces) {
  Facets facets;
  for (std::size_t n = 0; n < interfaces.size(); ++n) {
    facets.faces.insert(facets.faces.end(), interfaces[n].faces.begin(), interfaces[n].faces.end());
    facets.interface.resize(facets.faces.size(), static_cast<std::uint32_t>(n + 1));
    facets.inside.resize(facets.faces.size(), interfaces[n].inside);
    facets.outside.resize(facets.faces.size(), interfaces[n].outside);
  }
  return facets;
}

void add_interface_table(GridFiles& to, const TetMesh& mesh, const std::vector<Interface>& interfaces) {
  constexpr std::size_t kMostNameBytes = 255;
  const std::map<Label, std::string> tissues = set_names(mesh, {});
  InterfaceNames names(tissues, kMostNameBytes);
  pugi::xml_document maps;
  pugi::xml_node main = maps.append_child("main");
  std::vector<Label> labels;
  for (std::size_t n = 0; n < interfaces.size(); ++n) {
    const auto [inside, outside] = std::pair(interfaces[n].inside, interfaces[n].outside);
    const std::string name = names.name_of(inside, outside);
    pugi::xml_node map = append_map(main, name, "2", static_cast<std::uint32_t>(n + 1));
    map.append_attribute("inside") = number_text(inside).c_str();
    map.append_attribute("outside") = number_text(outside).c_str();
    labels.insert(labels.end(), {inside, outside});
  }
  to.add_information("interfaces", maps);
  to.h5().add("/interfaces/labels", NumberType::u32, labels.data(), interfaces.size(), 2);
}

void add_facets(GridFiles& to, const TetMesh& mesh, const GridFiles& points) {
  const std::vector<Interface> interfaces = interfaces_of(mesh);
  const Facets facets = facets_of(interfaces);
  const Cells cells(facets.faces.size(), is_quadratic(mesh) ? 6 : 3, mesh.points_mm.size(),
                    [&](std::size_t n) { return nodes_of_face(mesh, facets.faces[n]); });
  to.set_geometry(kPoints, points_of(mesh), &points);
  to.set_topology(is_quadratic(mesh) ? "Triangle_6" : "Triangle", "/facets/triangles", cells.table());
  to.add_cell_attribute("interface", "/facets/interface", list_of(facets.interface));
  to.add_cell_attribute("label", "/facets/label", list_of(facets.inside));
  to.add_cell_attribute("label_outside", "/facets/label_outside", list_of(facets.outside));
  add_interface_table(to, mesh, interfaces);
}

}  // namespace

void write_xdmf(const std::filesystem::path& path, const TetMesh& mesh) {
  std::filesystem::path facets_path = path;
  facets_path.replace_filename(path.stem().string() + "_facets" + path.extension().string());
  GridFiles tets(path, "mesh"), facets(facets_path, "facets");
  add_tets(tets, mesh);
  add_facets(facets, mesh, tets);
  std::vector<FileBytes> files;
  for (const GridFiles* grid : {&facets, &tets}) grid->take_bytes(files);
  write_whole_files(files);
}

}  // namespace anatomesh
