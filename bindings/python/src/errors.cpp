#include "errors.h"

#include <pybind11/pybind11.h>

#include "anatomesh/errors.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;

void raise(const char* name, const char* what) {
  PyErr_SetString(py::module_::import("anatomesh.errors").attr(name).ptr(), what);
}

}  // namespace

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InvalidOption& error) {
      raise("InvalidOption", error.what());
    } catch (const InvalidInput& error) {
      raise("InvalidInput", error.what());
    } catch (const MeshingFailed& error) {
      raise("MeshingFailed", error.what());
    } catch (const Cancelled& error) {
      raise("Cancelled", error.what());
    } catch (const Error& error) {
      raise("Error", error.what());
    }
  });
}

}  // namespace anatomesh::python
