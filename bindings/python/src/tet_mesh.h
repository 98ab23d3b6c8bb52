// Meshes as NumPy's arrays.
#pragma once

#include <pybind11/pybind11.h>

namespace anatomesh::python {

/// Adds the class TetMesh to the module, whose arrays are views of the mesh, and interfaces_of().
void bind_tet_mesh(pybind11::module_& module);

}  // namespace anatomesh::python
