#include "tet_mesh.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "anatomesh/errors.h"
#include "anatomesh/interfaces.h"
#include "anatomesh/quadratic.h"
#include "anatomesh/tet_mesh.h"
#include "label_image.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are shown as rows of three doubles");

/// The rows of a vector of a mesh; the array keeps the mesh alive. Read-only, since the mesh is.
template <class Number, class Row>
py::array view(const py::object& owner, const std::vector<Row>& rows) {
  constexpr auto kColumns = static_cast<py::ssize_t>(sizeof(Row) / sizeof(Number));
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(rows.size())};
  if (kColumns > 1) shape.push_back(kColumns);
  py::array array(py::dtype::of<Number>(), shape, reinterpret_cast<const Number*>(rows.data()), owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// An array that owns the numbers.
template <class Number, class Row>
py::array array_of(std::vector<Row> rows) {
  auto kept = std::make_unique<std::vector<Row>>(std::move(rows));
  const std::vector<Row>& data = *kept;
  const py::capsule owner(kept.release(), [](void* vector) { delete static_cast<std::vector<Row>*>(vector); });
  return view<Number>(owner, data);
}

template <class Number>
using RowsOf = py::array_t<Number, py::array::c_style | py::array::forcecast>;

template <class Number, class Row>
std::vector<Row> rows_of(const RowsOf<Number>& array, const char* name) {
  constexpr auto kColumns = static_cast<py::ssize_t>(sizeof(Row) / sizeof(Number));
  const bool fits = kColumns == 1 ? array.ndim() == 1 : array.ndim() == 2 && array.shape(1) == kColumns;
  if (!fits) {
    throw InvalidInput(std::string(name) + " is an array of shape " + std::string(py::str(array.attr("shape"))) +
                       "; it must be " + (kColumns == 1 ? "(n,)" : "(n, " + std::to_string(kColumns) + ")"));
  }
  std::vector<Row> rows(static_cast<std::size_t>(array.shape(0)));
  if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), array.data(), sizeof(Row) * rows.size());
  return rows;
}

void require_sound_edge_nodes(const TetMesh& mesh) {
  if (mesh.edge_nodes.empty()) return;
  if (mesh.edge_nodes.size() != mesh.tets.size()) {
    throw InvalidInput("there are edge nodes of " + std::to_string(mesh.edge_nodes.size()) + " tetrahedra for " +
                       std::to_string(mesh.tets.size()) + "; all must have them, or none");
  }
  for (const std::array<VertexId, 6>& nodes : mesh.edge_nodes) {
    const VertexId largest = std::ranges::max(nodes);
    if (largest < mesh.points_mm.size()) continue;
    throw InvalidInput("a tetrahedron has the edge node " + std::to_string(largest) + " of a mesh of " +
                       std::to_string(mesh.points_mm.size()) + " points; they are numbered from 0");
  }
}

void require_sound(const TetMesh& mesh) {
  if (mesh.labels.size() != mesh.tets.size()) {
    throw InvalidInput("there are " + std::to_string(mesh.labels.size()) + " labels for " +
                       std::to_string(mesh.tets.size()) + " tetrahedra; the numbers must be equal");
  }
  for (const std::array<VertexId, 4>& tet : mesh.tets) {
    const VertexId largest = std::ranges::max(tet);
    if (largest < mesh.points_mm.size()) continue;
    throw InvalidInput("a tetrahedron has the vertex " + std::to_string(largest) + " of a mesh of " +
                       std::to_string(mesh.points_mm.size()) + " points; vertices are numbered from 0");
  }
  require_sound_edge_nodes(mesh);
}

std::shared_ptr<TetMesh> mesh_of(const RowsOf<double>& points, const RowsOf<VertexId>& tets,
                                 const RowsOf<Label>& labels, const RowsOf<VertexId>& edge_nodes,
                                 const std::map<Label, std::string>& names, const std::map<Label, Colour>& colours) {
  auto mesh = std::make_shared<TetMesh>();
  mesh->points_mm = rows_of<double, Vec3>(points, "points");
  mesh->tets = rows_of<VertexId, std::array<VertexId, 4>>(tets, "tets");
  mesh->labels = rows_of<Label, Label>(labels, "labels");
  mesh->edge_nodes = rows_of<VertexId, std::array<VertexId, 6>>(edge_nodes, "edge_nodes");
  mesh->names = label_table_of(names, colours);
  require_sound(*mesh);
  return mesh;
}

/// The corners of the faces, their tetrahedra and the corners of these that they lie opposite to.
py::tuple arrays_of(const TetMesh& mesh, const Interface& interface) {
  std::vector<std::array<VertexId, 3>> triangles;
  std::vector<TetId> tets;
  std::vector<std::uint8_t> opposite;
  for (const TetFace& face : interface.faces) {
    triangles.push_back(corners_of(mesh, face));
    tets.push_back(face.tet);
    opposite.push_back(face.opposite);
  }
  return py::make_tuple(interface.inside, interface.outside, array_of<VertexId>(std::move(triangles)),
                        array_of<TetId>(std::move(tets)), array_of<std::uint8_t>(std::move(opposite)));
}

py::list interface_arrays(const TetMesh& mesh) {
  std::vector<Interface> interfaces;
  {
    const py::gil_scoped_release unlocked;
    interfaces = interfaces_of(mesh);
  }
  py::list result;
  for (const Interface& interface : interfaces) result.append(arrays_of(mesh, interface));
  return result;
}

/// A property whose array is a view of one of the mesh's vectors.
template <class Number, auto Rows>
py::array property(const py::object& self) {
  return view<Number>(self, self.cast<const TetMesh&>().*Rows);
}

}  // namespace

void bind_tet_mesh(py::module_& module) {
  using namespace py::literals;
  py::class_<TetMesh, std::shared_ptr<TetMesh>>(module, "TetMesh")
      .def(py::init(&mesh_of), "points"_a, "tets"_a, "labels"_a, "edge_nodes"_a, "names"_a, "colours"_a)
      .def_property_readonly("points", &property<double, &TetMesh::points_mm>)
      .def_property_readonly("tets", &property<VertexId, &TetMesh::tets>)
      .def_property_readonly("labels", &property<Label, &TetMesh::labels>)
      .def_property_readonly("edge_nodes", &property<VertexId, &TetMesh::edge_nodes>)
      .def_property_readonly("names", [](const TetMesh& mesh) { return names_in(mesh.names); })
      .def_property_readonly("colours", [](const TetMesh& mesh) {
        py::dict colours;
        for (const auto& [label, c] : colours_in(mesh.names))
          colours[py::int_(label)] = py::make_tuple(c[0], c[1], c[2]);
        return colours;
      });
  module.def(
      "with_order",
      [](const TetMesh& mesh, int order, double min_dihedral_deg, double max_dihedral_deg) {
        const py::gil_scoped_release unlocked;
        return std::make_shared<TetMesh>(order == 1 ? linear_mesh(mesh)
                                                    : quadratic_mesh(mesh, {min_dihedral_deg, max_dihedral_deg}));
      },
      "mesh"_a, "order"_a, "min_dihedral_deg"_a, "max_dihedral_deg"_a);
  module.def("interfaces_of", &interface_arrays, "mesh"_a);
}

}  // namespace anatomesh::python
