#include "options.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/materials.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;

[[noreturn]] void throw_wrong(const std::string& name, py::handle value, const std::string& right) {
  throw InvalidOption(name + " is " + std::string(py::repr(value)) + "; it must be " + right);
}

/// Throws InvalidOption with `right` unless Python's value is one of C++'s.
template <class Value>
Value cast_or_throw(const std::string& name, py::handle value, const char* right) {
  try {
    return value.cast<Value>();
  } catch (const py::cast_error&) {
    throw_wrong(name, value, right);
  }
}

// read() takes a value out of Python, written() brings it back. One pair a type.

void read(const std::string& name, py::handle value, double& to) {
  to = cast_or_throw<double>(name, value, "a number");
}
void read(const std::string& name, py::handle value, int& to) {
  to = cast_or_throw<int>(name, value, "a whole number");
}
void read(const std::string& name, py::handle value, std::uint64_t& to) {
  to = cast_or_throw<std::uint64_t>(name, value, "a whole number, at least 0");
}
void read(const std::string& name, py::handle value, bool& to) {
  to = cast_or_throw<bool>(name, value, "True or False");
}
void read(const std::string& name, py::handle value, std::vector<Label>& to) {
  to.clear();
  if (py::isinstance<py::str>(value) || !py::isinstance<py::iterable>(value))
    throw_wrong(name, value, "labels, e.g. [1, 2]");
  for (const py::handle label : value) to.push_back(cast_or_throw<Label>(name, label, "a label"));
}

template <class Value>
py::object written(const Value& value) {
  return py::cast(value);
}

template <class Enum>
struct Choice {
  const char* name;
  Enum value;
};

constexpr std::array<Choice<Frame>, 2> kFrames = {{{"lps", Frame::lps}, {"ras", Frame::ras}}};
constexpr std::array<Choice<FidelityStage>, 2> kFidelityStages = {
    {{"final", FidelityStage::final}, {"lattice", FidelityStage::lattice}}};
constexpr std::array<Choice<NonConnectivity>, 4> kNonConnectivities = {{{"vertex", NonConnectivity::vertex},
                                                                        {"edge", NonConnectivity::edge},
                                                                        {"face", NonConnectivity::face},
                                                                        {"none", NonConnectivity::none}}};
constexpr std::array<Choice<TissueKind>, 5> kTissueKinds = {{{"brain", TissueKind::brain},
                                                             {"ventricle", TissueKind::ventricle},
                                                             {"tumour", TissueKind::tumour},
                                                             {"vessel", TissueKind::vessel},
                                                             {"other", TissueKind::other}}};

const auto& choices_of(Frame) { return kFrames; }
const auto& choices_of(FidelityStage) { return kFidelityStages; }
const auto& choices_of(NonConnectivity) { return kNonConnectivities; }
const auto& choices_of(TissueKind) { return kTissueKinds; }

template <class Enum>
requires std::is_enum_v<Enum>
void read(const std::string& name, py::handle value, Enum& to) {
  std::string right;
  for (const Choice<Enum>& choice : choices_of(Enum{})) {
    if (py::isinstance<py::str>(value) && value.cast<std::string>() == choice.name) {
      to = choice.value;
      return;
    }
    right.append(right.empty() ? "'" : " or '").append(choice.name).append("'");
  }
  throw_wrong(name, value, right);
}

template <class Enum>
requires std::is_enum_v<Enum> py::object written(const Enum& value) {
  const auto& choices = choices_of(value);
  return py::str(std::ranges::find(choices, value, &Choice<Enum>::value)->name);
}

/// {"young_modulus_pa": 9000, "poisson_ratio": 0.45}, or a kind of tissue.
void read(const std::string& name, py::handle value, Material& to) {
  if (py::isinstance<py::str>(value)) {
    TissueKind kind{};
    read(name, value, kind);
    to = default_material(kind);
    return;
  }
  const std::array<std::pair<const char*, double*>, 2> members = {
      {{"young_modulus_pa", &to.young_modulus_pa}, {"poisson_ratio", &to.poisson_ratio}}};
  if (!py::isinstance<py::dict>(value))
    throw_wrong(name, value, "a kind of tissue, or a dict of young_modulus_pa and poisson_ratio");
  for (const auto& [key, number] : py::reinterpret_borrow<py::dict>(value)) {
    const auto member =
        std::ranges::find_if(members, [&, k = key](const auto& m) { return k.equal(py::str(m.first)); });
    if (member == members.end()) throw_wrong("a key of " + name, key, "'young_modulus_pa' or 'poisson_ratio'");
    read(name + " " + member->first, number, *member->second);
  }
}

py::object written(const Material& value) {
  using namespace py::literals;
  return py::dict("young_modulus_pa"_a = value.young_modulus_pa, "poisson_ratio"_a = value.poisson_ratio);
}

template <class Value>
void read(const std::string& name, py::handle value, std::map<Label, Value>& to, const Value& start) {
  if (!py::isinstance<py::dict>(value)) throw_wrong(name, value, "a dict by label");
  to.clear();
  for (const auto& [label, of_label] : py::reinterpret_borrow<py::dict>(value)) {
    Value& entry = to.emplace(cast_or_throw<Label>("a key of " + name, label, "a label"), start).first->second;
    read(name + "[" + std::string(py::repr(label)) + "]", of_label, entry);
  }
}

template <class Value>
py::object written(const std::map<Label, Value>& values) {
  py::dict result;
  for (const auto& [label, value] : values) result[py::int_(label)] = written(value);
  return result;
}

struct Field {
  const char* name;
  std::function<void(const std::string& name, py::handle value, Options& options)> set;
  std::function<py::object(const Options& options)> get;
};

/// `member` returns a reference to the member of the options it is given.
template <class Member>
Field field(const char* name, const Member& member) {
  const auto set = [member](const std::string& full_name, py::handle value, Options& options) {
    using Value = std::remove_reference_t<decltype(member(options))>;
    if constexpr (requires { typename Value::mapped_type; }) {
      read(full_name, value, member(options), typename Value::mapped_type{});
    } else {
      read(full_name, value, member(options));
    }
  };
  return {name, set, [member](const Options& options) { return written(member(options)); }};
}

/// A material that says only one of its numbers takes the other from the default one, which therefore comes first.
const std::vector<Field>& fields() {
  static const std::vector<Field> all = {
      field(
          "bcc_size_mm", [](auto& o) -> auto& { return o.lattice.bcc_size_mm; }),
      field(
          "min_size_mm", [](auto& o) -> auto& { return o.lattice.min_size_mm; }),
      field(
          "fidelity", [](auto& o) -> auto& { return o.lattice.fidelity; }),
      field(
          "fidelity_label", [](auto& o) -> auto& { return o.lattice.fidelity_label; }),
      field(
          "fidelity_stage", [](auto& o) -> auto& { return o.lattice.fidelity_stage; }),
      field(
          "max_elements", [](auto& o) -> auto& { return o.lattice.max_elements; }),
      field(
          "size_label", [](auto& o) -> auto& { return o.lattice.size_label; }),
      field(
          "elements_across", [](auto& o) -> auto& { return o.lattice.elements_across; }),
      field(
          "drop_islands", [](auto& o) -> auto& { return o.lattice.drop_islands; }),
      field(
          "allow_non_manifold", [](auto& o) -> auto& { return o.lattice.allow_non_manifold; }),
      field(
          "non_connectivity", [](auto& o) -> auto& { return o.deform.non_connectivity; }),
      field(
          "iterations", [](auto& o) -> auto& { return o.deform.iterations; }),
      field(
          "min_dihedral_deg", [](auto& o) -> auto& { return o.deform.min_dihedral_deg; }),
      field(
          "max_dihedral_deg", [](auto& o) -> auto& { return o.deform.max_dihedral_deg; }),
      field(
          "min_mean_ratio", [](auto& o) -> auto& { return o.deform.min_mean_ratio; }),
      field(
          "gradation", [](auto& o) -> auto& { return o.deform.gradation; }),
      field(
          "default_material", [](auto& o) -> auto& { return o.deform.default_material; }),
      {"material",
       [](const std::string& name, py::handle value, Options& o) {
         read(name, value, o.deform.material, o.deform.default_material);
       },
       [](const Options& o) { return written(o.deform.material); }},
      field(
          "labels", [](auto& o) -> auto& { return o.labels; }),
      field(
          "frame", [](auto& o) -> auto& { return o.frame; }),
      field(
          "order", [](auto& o) -> auto& { return o.order; }),
      field(
          "threads", [](auto& o) -> auto& { return o.threads; }),
      field(
          "max_memory_gib", [](auto& o) -> auto& { return o.max_memory_gib; }),
  };
  return all;
}

}  // namespace

Options options_of(const py::dict& given) {
  Options options;
  std::size_t known = 0;
  for (const Field& field : fields()) {
    if (!given.contains(field.name)) continue;
    field.set(field.name, given[field.name], options);
    ++known;
  }
  if (known != given.size()) throw py::type_error("a key is not the name of an option");
  return options;
}

py::dict dict_of(const Options& options) {
  py::dict result;
  for (const Field& field : fields()) result[field.name] = field.get(options);
  return result;
}

Frame frame_of(const py::handle& given) {
  Frame frame{};
  read("frame", given, frame);
  return frame;
}

}  // namespace anatomesh::python
