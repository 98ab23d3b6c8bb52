#include "meshing.h"

#include <pybind11/stl.h>

#include <atomic>
#include <memory>
#include <optional>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/remesher.h"
#include "label_image.h"
#include "long_call.h"
#include "options.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

py::dict as_dict(const TissueOutcome& v) {
  return py::dict("label"_a = v.label, "voxels"_a = v.voxels, "tets"_a = v.tets, "fidelity"_a = v.fidelity,
                  "lattice_f1"_a = v.lattice_f1, "lattice_f2"_a = v.lattice_f2, "f1"_a = v.f1, "f2"_a = v.f2);
}

py::dict as_dict(const UpdateReport& v) {
  return py::dict("changed_voxels"_a = v.changed_voxels, "new_tets"_a = v.new_tets, "whole"_a = v.whole,
                  "reason"_a = v.reason, "seconds"_a = v.seconds);
}

/// The mesh moves into the object that its arrays are views of.
py::dict as_dict(Result&& v) {
  py::list tissues;
  for (const TissueOutcome& tissue : v.tissues) tissues.append(as_dict(tissue));
  py::dict times;
  for (const StageTime& time : v.times) times[py::str(time.stage)] = time.seconds;
  return py::dict("mesh"_a = std::make_shared<TetMesh>(std::move(v.mesh)), "tissues"_a = tissues,
                  "warnings"_a = v.warnings, "times"_a = times, "options"_a = dict_of(v.options));
}

py::dict meshed(const LabelImage& image, const py::dict& given, const py::object& progress) {
  const Options options = options_of(given);
  Result result;
  do_long_work(progress, [&](const Progress& p) { result = image_to_mesh(image, options, p); });
  return as_dict(std::move(result));
}

/// A Remesher that is used by one call at a time. What it shows is a copy, since arrays may outlive the next update.
class GuardedRemesher {
 public:
  GuardedRemesher(const LabelImage& image, const py::dict& given, const py::object& progress) {
    const Options options = options_of(given);
    do_long_work(progress, [&](const Progress& p) { remesher_.emplace(image, options, p); });
  }

  UpdateReport update(const LabelImage& changed, const py::object& progress) {
    const Turn turn(busy_);
    UpdateReport report;
    do_long_work(progress, [&](const Progress& p) { report = remesher_->update(changed, p); });
    return report;
  }

  py::dict result() {
    const Turn turn(busy_);
    return as_dict(Result(remesher_->result()));
  }

 private:
  /// Throws where another thread, or a callback of progress, came in between.
  struct Turn {
    explicit Turn(std::atomic<bool>& flag) : busy(flag) {
      if (busy.exchange(true)) throw Error("the Remesher is at work on an update; wait until it is done");
    }
    ~Turn() { busy = false; }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    std::atomic<bool>& busy;
  };

  std::optional<Remesher> remesher_;
  std::atomic<bool> busy_ = false;
};

}  // namespace

void bind_meshing(py::module_& module) {
  py::class_<LabelImage>(module, "LabelImage")
      .def(py::init(&label_image_of), "voxels"_a, "spacing"_a, "origin"_a, "direction"_a, "names"_a, "colours"_a)
      .def("keep_labels", &keep_labels, "labels"_a, py::call_guard<py::gil_scoped_release>());
  module.def("image_to_mesh", &meshed, "image"_a, "options"_a, "progress"_a);
  module.def("default_options", [] { return dict_of(Options{}); });
  py::class_<GuardedRemesher>(module, "Remesher")
      .def(py::init<const LabelImage&, const py::dict&, const py::object&>(), "image"_a, "options"_a, "progress"_a)
      .def(
          "update",
          [](GuardedRemesher& remesher, const LabelImage& changed, const py::object& progress) {
            return as_dict(remesher.update(changed, progress));
          },
          "changed"_a, "progress"_a)
      .def("result", &GuardedRemesher::result);
}

}  // namespace anatomesh::python
