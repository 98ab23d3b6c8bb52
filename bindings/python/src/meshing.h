// image_to_mesh() and the Remesher.
#pragma once

#include <pybind11/pybind11.h>

namespace anatomesh::python {

/// Adds the class LabelImage, image_to_mesh(), the class Remesher and default_options() to the module.
void bind_meshing(pybind11::module_& module);

}  // namespace anatomesh::python
