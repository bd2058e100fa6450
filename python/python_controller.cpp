#include <algorithm>
#include <memory>
#include <stdexcept>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

/// Calls with the GIL. Exceptions of Python become std::runtime_error with their last line.
template <class Call>
auto in_python(const std::string& file, Call&& call) {
  const py::gil_scoped_acquire gil;
  try {
    return call();
  } catch (py::error_already_set& error) {
    throw std::runtime_error(last_line(error, file));
  }
}

/// One line, whatever the text.
std::string text_of(py::handle text) {
  std::string line = py::bytes(py::str(text).attr("encode")("utf-8", "backslashreplace"));
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

constexpr const char* expected_of(const Twist&) { return "three numbers (forward, left, turn) in m/s, m/s and rad/s"; }
constexpr const char* expected_of(bool) { return "True or False"; }
constexpr const char* expected_of(double) { return "a number"; }

/// @param from with its file, such as "mine.py: step() returned "
template <class Value>
Value value_of(const py::object& given, const std::string& from) {
  py::detail::make_caster<Value> value;
  if (!value.load(given, true))
    throw std::runtime_error(from + text_of(py::repr(given)) + "; expected " + expected_of(Value{}));
  return py::detail::cast_op<Value&>(value);
}

class PythonController final : public Controller {
 public:
  PythonController(std::string file, Robot robot, py::object object)
      : file_(std::move(file)),
        robot_(std::move(robot)),
        object_(std::move(object)),
        has_done_(py::hasattr(object_, "done")),
        has_error_(py::hasattr(object_, "error")) {}
  PythonController(const PythonController&) = delete;
  PythonController& operator=(const PythonController&) = delete;
  ~PythonController() override {
    if (Py_IsInitialized() != 0) {
      const py::gil_scoped_acquire gil;
      object_ = py::object();
    } else {
      object_.release();
    }
  }

  Twist step(const Input& input) override {
    return in_python(file_, [&] { return returned<Twist>("step", input_of(input, robot_)); });
  }
  double radio_range() const override {
    return in_python(file_,
                     [&] { return py::hasattr(object_, "radio_range") ? returned<double>("radio_range") : 0.0; });
  }
  bool done() const override {
    return has_done_ && in_python(file_, [&] { return returned<bool>("done"); });
  }
  double error() const override {
    return has_error_ ? in_python(file_, [&] { return returned<double>("error"); }) : Controller::error();
  }

 private:
  template <class Value, class... Arguments>
  Value returned(const char* method, const Arguments&... arguments) const {
    return value_of<Value>(object_.attr(method)(arguments...), file_ + ": " + method + "() returned ");
  }

  std::string file_;
  Robot robot_;
  py::object object_;
  bool has_done_, has_error_;
};

std::string file_of(py::handle type) {
  const py::object module = py::module_::import("sys").attr("modules").attr("get")(type.attr("__module__"));
  return py::str(py::getattr(module, "__file__", py::str("")));
}

template <class Value>
Value attribute(py::handle type, const char* name, Value fallback) {
  if (!py::hasattr(type, name)) return fallback;
  return value_of<Value>(type.attr(name),
                         std::string("'") + name + "' of class " + text_of(type.attr("__name__")) + " is ");
}

std::string first_line(py::handle text) {
  const std::string all = text.is_none() ? "" : py::str(text.attr("strip")());
  return all.substr(0, all.find('\n'));
}

}  // namespace

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
  const bool is_syntax = error.matches(PyExc_SyntaxError);  // its place is not that of a frame
  if (is_syntax && !error.value().attr("filename").is_none())
    place = py::str("{}:{}: ").format(error.value().attr("filename"), error.value().attr("lineno"));
  const py::list lines = traceback.attr("format_exception_only")(error.type(), error.value());
  return place + text_of(lines[lines.size() - 1].attr("strip")());
}

ControllerEntry entry_of(py::handle type) {
  ControllerEntry entry;
  entry.name = type.attr("__name__").cast<std::string>();
  entry.summary = first_line(type.attr("__doc__"));
  entry.rate = attribute(type, "rate", entry.rate);
  entry.stops_on_bumper = attribute(type, "stops_on_bumper", entry.stops_on_bumper);
  type.inc_ref();
  entry.make = [type, file = file_of(type)](const Robot& robot, Settings& settings) {
    return in_python(file, [&]() -> std::unique_ptr<Controller> {
      return std::make_unique<PythonController>(file, robot, with_settings(settings, type, robot));
    });
  };
  return entry;
}

}  // namespace sensorfarm::python
