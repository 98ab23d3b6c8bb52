// Calls of the library that take long, seen from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "anatomesh/progress.h"

namespace anatomesh::python {

/// Does the work on a thread of its own, without the interpreter's lock, so that other threads of Python go on. The
/// calling thread meanwhile hands progress to `report(stage, fraction)`, which may be None, and looks for signals: the
/// work hears of Ctrl-C within a tenth of a second, and a slow `report` holds nothing up. Throws what the work throws;
/// Cancelled where `report` returned False; what `report` or a handler of signals raised.
void do_long_work(const pybind11::object& report, const std::function<void(const Progress&)>& work);

}  // namespace anatomesh::python
