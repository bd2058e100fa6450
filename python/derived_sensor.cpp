// Derived sensors written in Python.

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

py::object site_object(const DerivedSite& site, const std::vector<InputPort>& ports) {
  const py::object made = py::module_::import("types").attr("SimpleNamespace");
  py::list inputs;
  for (const DerivedInput& input : site.inputs)
    inputs.append(made(py::arg("port") = ports.at(input.port).name, py::arg("robot") = input.robot,
                       py::arg("sensor") = input.sensor));
  return made(py::arg("name") = site.sensor.name, py::arg("robot") = site.sensor.robot,
              py::arg("number") = site.sensor.number, py::arg("X_RS") = site.sensor.X_RS, py::arg("start") = site.start,
              py::arg("inputs") = inputs);
}

/// The settings as functions, which refuse calls after __init__.
py::object settings_object(const std::shared_ptr<const SensorSettings*>& lent) {
  const auto of = [lent](auto read) {
    return py::cpp_function(
        [lent, read](const std::string& key, double fallback, double least, double most) {
          if (*lent == nullptr) throw py::value_error("settings can be read in __init__ only");
          return read(**lent, key, fallback, least, most);
        },
        py::arg("key"), py::arg("fallback"), py::arg("least") = -1e300, py::arg("most") = 1e300);
  };
  using Given = const SensorSettings&;
  using Key = const std::string&;
  const auto text = [lent](Key key, Key fallback) {
    if (*lent == nullptr) throw py::value_error("settings can be read in __init__ only");
    return (*lent)->text(key, fallback);
  };
  return py::module_::import("types").attr("SimpleNamespace")(
      py::arg("number") =
          of([](Given s, Key k, double f, double least, double most) { return s.number(k, f, least, most); }),
      py::arg("length") =
          of([](Given s, Key k, double f, double least, double most) { return s.length(k, f, least, most); }),
      py::arg("angle") =
          of([](Given s, Key k, double f, double least, double most) { return s.angle(k, f, least, most); }),
      py::arg("text") = py::cpp_function(text, py::arg("key"), py::arg("fallback")));
}

class PythonDerivedSensor final : public DerivedSensor {
 public:
  PythonDerivedSensor(std::string file, py::object object, const DerivedSite& site)
      : file_(std::move(file)), object_(std::move(object)) {
    for (const DerivedInput& input : site.inputs) columns_.push_back(input.sensor.columns.size());
  }

  void take(std::uint32_t input, const Reading& reading) override {
    in_python(file_, [&] { object_->attr("take")(input, reading_object(reading, columns_.at(input))); });
  }
  void read(double time, DerivedReading out) override {
    in_python(file_, [&] { put(object_->attr("read")(time), out); });
  }
  void add_input(const DerivedInput& input) override {
    columns_.push_back(input.sensor.columns.size());
    in_python(file_, [&] {
      if (py::hasattr(*object_, "add_input")) object_->attr("add_input")(input.robot, input.sensor);
    });
  }

 private:
  void put(const py::object& given, DerivedReading& out) const {
    if (given.is_none()) {
      std::fill(out.valid.begin(), out.valid.end(), std::uint8_t{0});
      return;
    }
    const bool both = py::isinstance<py::tuple>(given) && py::len(given) == 2 && !out.covariance.empty();
    fill(both ? given[py::int_(0)] : py::reinterpret_borrow<py::object>(given), out.values, "numbers");
    if (both) fill(given[py::int_(1)], out.covariance, "numbers of the covariance");
  }
  void fill(const py::object& given, std::span<double> to, const char* what) const {
    const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(given);
    if (!numbers || static_cast<std::size_t>(numbers.size()) != to.size()) {
      PyErr_Clear();
      throw std::runtime_error(place_of(object_->attr("read")) + "read() returned " +
                               py::repr(given).cast<std::string>() + "; expected " + std::to_string(to.size()) + " " +
                               what + ", or None");
    }
    std::copy_n(numbers.data(), to.size(), to.begin());
  }

  std::string file_;
  HeldObject object_;
  std::vector<std::size_t> columns_;  ///< per input
};

template <class Value>
Value own_attribute(py::handle type, const char* name, Value fallback) {
  if (!py::hasattr(type, name)) return fallback;
  try {
    return type.attr(name).cast<Value>();
  } catch (const py::cast_error&) {
    throw std::runtime_error(place_of(type) + "'" + name + "' of class " + type.attr("__name__").cast<std::string>() +
                             " is " + py::repr(type.attr(name)).cast<std::string>());
  }
}

}  // namespace

DerivedEntry derived_entry_of(py::handle type, const std::string& file) {
  DerivedEntry entry;
  entry.name = own_attribute(type, "name", type.attr("__name__").cast<std::string>());
  entry.id = own_attribute<std::uint8_t>(type, "id", 0);
  for (const auto& [name, unit] : own_attribute(type, "columns", py::dict()))
    entry.columns.push_back({name.cast<std::string>(), unit.cast<double>()});
  for (const auto& [name, columns] : own_attribute(type, "ports", py::dict()))
    entry.ports.push_back({name.cast<std::string>(), columns.cast<std::vector<std::string>>(), 0, 1u << 20});
  entry.keys = own_attribute(type, "keys", std::vector<std::string>());
  entry.rate = own_attribute(type, "rate", entry.rate);
  entry.rows = own_attribute(type, "rows", entry.rows);
  entry.covariance = own_attribute(type, "covariance", entry.covariance);
  type.inc_ref();  // for the rest of the program
  entry.make = [type, file, ports = entry.ports](const DerivedSite& site, const SensorSettings& settings) {
    return in_python(file, [&]() -> std::unique_ptr<DerivedSensor> {
      const auto lent = std::make_shared<const SensorSettings*>(&settings);
      struct Return {
        const SensorSettings*& lent;
        ~Return() { lent = nullptr; }
      } const give_back{*lent};
      py::object made = type(site_object(site, ports), settings_object(lent));
      return std::make_unique<PythonDerivedSensor>(file, std::move(made), site);
    });
  };
  return entry;
}

}  // namespace sensorfarm::python
