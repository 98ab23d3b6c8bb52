// The extension module. What users see is the Python beside it, in anatomesh/.
#include <pybind11/pybind11.h>

#include "anatomesh/version.h"
#include "assessment.h"
#include "errors.h"
#include "meshing.h"
#include "tet_mesh.h"

PYBIND11_MODULE(_core, module) {
  namespace python = anatomesh::python;
  module.attr("version") = anatomesh::version();
  python::translate_errors();
  python::bind_tet_mesh(module);
  python::bind_meshing(module);
  python::bind_assess(module);
}
