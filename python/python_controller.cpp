#include <algorithm>
#include <memory>
#include <stdexcept>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

constexpr const char* expected_of(const Twist&) { return "three numbers (forward, left, turn) in m/s, m/s and rad/s"; }
constexpr const char* expected_of(bool) { return "True or False"; }
constexpr const char* expected_of(double) { return "a number"; }
using Names = std::optional<std::vector<std::string>>;
constexpr const char* expected_of(const Names&) { return "None or a list of sensor types, such as ['sonar']"; }
constexpr const char* expected_of(std::uint8_t) { return "a whole number from 0 to 255"; }

/// @param from origin of the value, called if it has another type: "mine.py:7: step() returned "
template <class Value, class From>
Value value_of(const py::object& given, const From& from) {
  py::detail::make_caster<Value> value;
  if (!value.load(given, true))
    throw std::runtime_error(from() + object_text(py::repr(given)) + "; expected " + expected_of(Value{}));
  return py::detail::cast_op<Value&>(value);
}

class PythonController final : public Controller {
 public:
  PythonController(std::string file, Robot robot, py::object object)
      : file_(std::move(file)),
        robot_(std::move(robot)),
        object_(std::move(object)),
        has_done_(py::hasattr(*object_, "done")),
        has_error_(py::hasattr(*object_, "error")),
        has_outputs_(py::hasattr(*object_, "outputs")) {}
  Twist step(const Input& input) override {
    return in_python(file_, [&] { return returned<Twist>("step", input_of(input, robot_)); });
  }
  double radio_range() const override {
    return in_python(file_,
                     [&] { return py::hasattr(*object_, "radio_range") ? returned<double>("radio_range") : 0.0; });
  }
  bool done() const override {
    return has_done_ && in_python(file_, [&] { return returned<bool>("done"); });
  }
  double error() const override {
    return has_error_ ? in_python(file_, [&] { return returned<double>("error"); }) : Controller::error();
  }
  std::optional<std::vector<std::string>> sufficient_sensors() const override {
    if (!in_python(file_, [&] { return py::hasattr(*object_, "sufficient_sensors"); })) return std::nullopt;
    return in_python(file_, [&] { return returned<Names>("sufficient_sensors"); });
  }
  std::uint8_t outputs() const override {
    return has_outputs_ ? in_python(file_, [&] { return returned<std::uint8_t>("outputs"); }) : std::uint8_t{0};
  }

 private:
  template <class Value, class... Arguments>
  Value returned(const char* method, const Arguments&... arguments) const {
    const py::object bound = object_->attr(method);
    return value_of<Value>(bound(arguments...), [&] { return place_of(bound) + method + "() returned "; });
  }

  std::string file_;
  Robot robot_;
  HeldObject object_;
  bool has_done_, has_error_, has_outputs_;
};

/// Returns whether the callable takes these arguments: Python's `bind` refuses them otherwise. Callables without a
/// signature, such as those of extension modules, are checked only by the call itself.
bool takes(const py::object& callable, int arguments) {
  const py::module_ inspect = py::module_::import("inspect");
  try {
    const py::object signature = inspect.attr("signature")(callable);
    const py::object values = py::reinterpret_steal<py::object>(PyTuple_New(arguments));
    for (int i = 0; i < arguments; ++i) PyTuple_SET_ITEM(values.ptr(), i, py::none().release().ptr());
    try {
      signature.attr("bind")(*values);
    } catch (py::error_already_set& error) {
      return !error.matches(PyExc_TypeError);
    }
  } catch (py::error_already_set&) {
  }
  return true;
}

}  // namespace

void check_constructor(py::handle type, const std::string& first) {
  const std::string expected = "expected def __init__(self, " + first + ", settings)";
  if (takes(py::reinterpret_borrow<py::object>(type), 2)) return;
  const std::string name = object_text(type.attr("__name__"));
  const py::object made = type.attr("__init__");
  if (!py::hasattr(made, "__code__"))
    throw std::runtime_error(place_of(type) + "class " + name + " has no __init__; " + expected);
  throw std::runtime_error(place_of(made) + name + ".__init__" +
                           object_text(py::str(py::module_::import("inspect").attr("signature")(made))) +
                           " has other parameters; " + expected);
}

void check_method(const py::object& object, const char* method, const char* parameters, int arguments) {
  if (!py::hasattr(object, method)) return;
  const py::object bound = object.attr(method);
  const bool callable = PyCallable_Check(bound.ptr()) != 0;
  if (callable && takes(bound, arguments)) return;
  const std::string name = object_text(py::type::of(object).attr("__name__")) + "." + method;
  throw std::runtime_error(place_of(py::hasattr(bound, "__code__") ? bound : py::type::of(object)) + name +
                           (callable ? " has other parameters" : " is not a method") + "; expected def " + method +
                           parameters);
}

namespace {

/// @throws std::runtime_error with the place and the expected signature of the first method that cannot be called
py::object with_checked_methods(py::object object) {
  check_method(object, "step", "(self, input)", 1);
  for (const char* method : {"radio_range", "done", "error", "outputs", "sufficient_sensors"})
    check_method(object, method, "(self)", 0);
  return object;
}

template <class Value>
Value attribute(py::handle type, const char* name, Value fallback) {
  if (!py::hasattr(type, name)) return fallback;
  return value_of<Value>(type.attr(name), [&] {
    return place_of(type) + "'" + name + "' of class " + object_text(type.attr("__name__")) + " is ";
  });
}

}  // namespace

/// One line, whatever the text.
std::string object_text(py::handle text) {
  std::string line = py::bytes(py::str(text).attr("encode")("utf-8", "backslashreplace"));
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

std::string file_of(py::handle type) {
  const py::object module = py::module_::import("sys").attr("modules").attr("get")(type.attr("__module__"));
  return py::str(py::getattr(module, "__file__", py::str("")));
}

std::string first_line(py::handle text) {
  const std::string all = text.is_none() ? "" : py::str(text.attr("strip")());
  return all.substr(0, all.find('\n'));
}

std::string last_line(py::error_already_set& error, const std::string& file) {
  const py::module_ traceback = py::module_::import("traceback");
  const py::object tb = error.trace() ? error.trace() : py::none();
  std::string place;
  bool in_file = false;
  for (const py::handle frame : traceback.attr("extract_tb")(tb)) {
    const std::string name = py::str(frame.attr("filename"));
    if ((in_file && name != file) || name.front() == '<') continue;
    in_file = name == file;
    place = name + ":" + py::str(frame.attr("lineno")).cast<std::string>() + ": ";
  }
  const bool is_syntax = error.matches(PyExc_SyntaxError);  // the location is not that of a frame
  if (is_syntax && !error.value().attr("filename").is_none())
    place = py::str("{}:{}: ").format(error.value().attr("filename"), error.value().attr("lineno"));
  const py::list lines = traceback.attr("format_exception_only")(error.type(), error.value());
  return place + object_text(lines[lines.size() - 1].attr("strip")());
}

std::string place_of(py::handle thing) {
  const py::module_ inspect = py::module_::import("inspect");
  try {
    const py::object plain = inspect.attr("unwrap")(thing);
    const auto text = [](const py::object& file, const py::object& line) {
      return py::str("{}:{}: ").format(file, line).cast<std::string>();
    };
    if (py::hasattr(plain, "__code__"))
      return text(plain.attr("__code__").attr("co_filename"), plain.attr("__code__").attr("co_firstlineno"));
    return text(inspect.attr("getsourcefile")(plain), inspect.attr("getsourcelines")(plain)[py::int_(1)]);
  } catch (py::error_already_set&) {  // a class without source
    return "";
  }
}

ControllerEntry entry_of(py::handle type) {
  ControllerEntry entry;
  entry.name = type.attr("__name__").cast<std::string>();
  entry.summary = first_line(type.attr("__doc__"));
  entry.rate = attribute(type, "rate", entry.rate);
  entry.stops_on_bumper = attribute(type, "stops_on_bumper", entry.stops_on_bumper);
  entry.on_scans = attribute(type, "on_scans", entry.on_scans);
  type.inc_ref();
  entry.make = [type, file = file_of(type), checked = false](const Robot& robot, Settings& settings) mutable {
    return in_python(file, [&]() -> std::unique_ptr<Controller> {
      if (!checked) check_constructor(type, "robot");
      py::object object = with_settings(settings, type, py::cast(robot));
      if (!checked) object = with_checked_methods(std::move(object));
      checked = true;
      return std::make_unique<PythonController>(file, robot, std::move(object));
    });
  };
  return entry;
}

}  // namespace sensorfarm::python
