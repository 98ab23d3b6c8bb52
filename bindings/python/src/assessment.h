// What is measured of a mesh, as dicts.
#pragma once

#include <pybind11/pybind11.h>

namespace anatomesh::python {

/// Adds assess() to the module. Keys are those of the report of `anatomesh check`; None for what was not measured.
void bind_assess(pybind11::module_& module);

}  // namespace anatomesh::python
