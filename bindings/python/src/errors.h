// The exceptions of the library as those of anatomesh/errors.py.
#pragma once

namespace anatomesh::python {

/// Makes each of them one of Python's, wherever it leaves the library.
void translate_errors();

}  // namespace anatomesh::python
