// The options of the mesher as a dict of Python.
#pragma once

#include <pybind11/pybind11.h>

#include "anatomesh/options.h"

namespace anatomesh::python {

/// The defaults, but for what the dict says. Keys are the names of the members in include/anatomesh/options.h. Throws
/// InvalidOption (a value of another kind), TypeError (a key that is no option); ranges are checked by the library.
Options options_of(const pybind11::dict& given);

/// Every option.
pybind11::dict dict_of(const Options& options);

/// "lps" or "ras". Throws InvalidOption.
Frame frame_of(const pybind11::handle& given);
pybind11::str name_of(Frame frame);

}  // namespace anatomesh::python
