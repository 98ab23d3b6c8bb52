#include "io/cell_arrays.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "anatomesh/errors.h"
#include "io/number_text.h"
#include "io/output_file.h"

namespace anatomesh {
namespace {

/// Names that tools give to the array of tissues, in small letters, the best first.
constexpr std::array kLabelNames = {
    "label",       "labels",        "labelid",          "medit:ref", "gmsh:physical", "material",  "materials",
    "material_id", "materialid",    "region",           "regions",   "region_id",     "regionid",  "tissue",
    "tissues",     "cellentityids", "cell_tags",        "tag",       "tags",          "attribute", "subdomain",
    "subdomains",  "domain",        "gmsh:geometrical", "scalars"};

/// Integral arrays that number cells and say nothing about tissues, in small letters.
constexpr std::array kIdNames = {"vtkghosttype",    "vtkoriginalcellids", "globalids", "globalcellids",
                                 "globalelementid", "pedigreeids",        "cellid",    "cellids"};

std::string small_letters(const std::string& name) {
  std::string text = name;
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_integral(const CellArray& array) {
  return array.values.type != NumberType::f32 && array.values.type != NumberType::f64;
}

/// One label a cell.
std::vector<Label> labels_of(const std::filesystem::path& path, const CellArrays& cells) {
  std::vector<Label> labels(cells.types.size(), Label{1});
  const auto chosen = label_array(cells.arrays);
  if (!chosen) return labels;
  const CellArray* const array = &cells.arrays[*chosen];
  if (array->values.size() != labels.size()) {
    throw_damaged(
        path, "it has " + number_text(array->values.size()) + " labels for " + number_text(labels.size()) + " cells");
  }
  if (const auto bad = store_labels(array->values.type, array->values.bytes.data(), labels.size(), labels.data())) {
    throw InvalidInput("cell " + number_text(bad->position) + " of " + in_quotes(path) + " has the value " +
                       bad->value + " in the array '" + array->name + "'; " + kLabelRule);
  }
  return labels;
}

/// Empty where the file has none.
LabelTable names_of(const std::filesystem::path& path, const CellArrays& cells) {
  const std::size_t count = cells.label_names.size();
  std::vector<Label> labels(count);
  if (cells.label_values.size() != count) throw_damaged(path, "its label names are not as many as their values");
  if (store_labels(cells.label_values.type, cells.label_values.bytes.data(), count, labels.data()))
    throw_damaged(path, "its label names have values that are no labels");
  const bool has_colours = cells.label_colours.type == NumberType::u8 && cells.label_colours.size() == 3 * count;
  LabelTable names;
  for (std::size_t n = 0; n < count; ++n) {
    LabelEntry& entry = names[labels[n]];
    entry.name = cells.label_names[n];
    if (!has_colours) continue;
    const auto part = [&](std::size_t c) { return static_cast<std::uint8_t>(cells.label_colours.bytes[3 * n + c]); };
    entry.colour = Colour{part(0), part(1), part(2)};
  }
  return names;
}

/// Throws unless every cell can be followed to its corners.
void check_offsets(const std::filesystem::path& path, const CellArrays& cells) {
  if (cells.offsets.size() != cells.types.size() + 1) {
    throw_damaged(path, "it has " + number_text(cells.types.size()) + " cell types and " +
                            number_text(cells.offsets.size()) + " cell offsets");
  }
  const auto most = static_cast<std::int64_t>(cells.corners.size());
  std::int64_t before = 0;
  for (const std::int64_t offset : cells.offsets) {
    if (offset < before || offset > most)
      throw_damaged(path, "the cell offset " + number_text(offset) + " is out of order");
    before = offset;
  }
}

/// Nodes of cell n from its first-th on.
template <std::size_t count>
std::array<VertexId, count> nodes_at(const std::filesystem::path& path, const CellArrays& cells, std::size_t n,
                                     std::size_t first) {
  std::array<VertexId, count> nodes;
  for (std::size_t node = 0; node < count; ++node) {
    const std::int64_t id = cells.corners[static_cast<std::size_t>(cells.offsets[n]) + first + node];
    if (id < 0 || static_cast<std::size_t>(id) >= cells.points_mm.size()) {
      throw_damaged(path, "cell " + number_text(n) + " refers to point " + number_text(id) + " of " +
                              number_text(cells.points_mm.size()));
    }
    nodes[node] = static_cast<VertexId>(id);
  }
  return nodes;
}

/// Appends cell n, which is a tetrahedron.
void add_tet(const std::filesystem::path& path, const CellArrays& cells, std::size_t n, TetMesh& mesh) {
  const bool is_quadratic = cells.types[n] == kVtkQuadraticTetra;
  if (cells.offsets[n + 1] - cells.offsets[n] != (is_quadratic ? 10 : 4)) {
    throw_damaged(
        path, "cell " + number_text(n) + " is a tetrahedron without " + (is_quadratic ? "ten nodes" : "four corners"));
  }
  mesh.tets.push_back(nodes_at<4>(path, cells, n, 0));
  if (is_quadratic) mesh.edge_nodes.push_back(nodes_at<6>(path, cells, n, 4));
}

}  // namespace

void throw_damaged(const std::filesystem::path& path, const std::string& why) {
  throw IoError(in_quotes(path) + " is truncated or damaged: " + why);
}

void check_kinds(const std::filesystem::path& path, std::size_t linear_tets, std::size_t quadratic_tets) {
  if (linear_tets + quadratic_tets == 0) throw InvalidInput(in_quotes(path) + " has no tetrahedra of 4 or 10 nodes");
  if (linear_tets == 0 || quadratic_tets == 0) return;
  throw InvalidInput(in_quotes(path) + " has " + number_text(linear_tets) + " linear and " +
                     number_text(quadratic_tets) + " quadratic tetrahedra; only one kind in a mesh can be read");
}

std::optional<std::size_t> label_array(const std::vector<CellArray>& arrays) {
  for (const char* name : kLabelNames) {
    for (std::size_t n = 0; n < arrays.size(); ++n) {
      if (small_letters(arrays[n].name) == name) return n;
    }
  }
  for (std::size_t n = 0; n < arrays.size(); ++n) {
    const bool is_id = std::find(kIdNames.begin(), kIdNames.end(), small_letters(arrays[n].name)) != kIdNames.end();
    if (is_integral(arrays[n]) && !is_id) return n;
  }
  return std::nullopt;
}

TetMesh tet_mesh_from(const std::filesystem::path& path, CellArrays cells) {
  if (cells.points_mm.size() > std::numeric_limits<VertexId>::max()) {
    throw InvalidInput(in_quotes(path) + " has " + number_text(cells.points_mm.size()) +
                       " points; at most 4294967295 can be read");
  }
  check_offsets(path, cells);
  const std::vector<Label> labels = labels_of(path, cells);
  TetMesh mesh;
  for (std::size_t n = 0; n < cells.types.size(); ++n) {
    if (cells.types[n] != kVtkTetra && cells.types[n] != kVtkQuadraticTetra) continue;
    add_tet(path, cells, n, mesh);
    mesh.labels.push_back(labels[n]);
  }
  check_kinds(path, mesh.tets.size() - mesh.edge_nodes.size(), mesh.edge_nodes.size());
  mesh.points_mm = std::move(cells.points_mm);
  mesh.names = names_of(path, cells);
  return mesh;
}

}  // namespace anatomesh
