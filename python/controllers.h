#pragma once
// Controllers, model controllers and derived sensors written in Python. A controller is a class with
// __init__(self, robot, settings) and step(self, input) -> (forward, left, turn). Optional: class attributes `rate`
// [Hz], `on_scans` and `stops_on_bumper`, methods radio_range(), done() and error() (sensorfarm/controller.h). A model
// controller is a class with __init__(self, model, settings) and tick(self, model). Optional: contact(self, contact,
// model) and range(self) (sensorfarm/model.h).

#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "sensorfarm/controller.h"
#include "sensorfarm/derived.h"
#include "sensorfarm/model.h"

namespace sensorfarm::python {

/// Adds Robot, SensorInfo, Input, Reading, Neighbour, Light and Settings, local to the library that calls this.
void add_controller_types(pybind11::module_& module);
/// The same for Model, ModelSite, ModelContact and NearRobot.
void add_model_types(pybind11::module_& module);

/// Returns "mine.py:12: ValueError: too fast" with the innermost line in `file`, or the innermost line if there is
/// none. Requires the GIL.
std::string last_line(pybind11::error_already_set& error, const std::string& file);

/// Returns "mine.py:12: " for a class, method or function; empty if its source is not available. Requires the GIL.
std::string place_of(pybind11::handle thing);

/// Calls with the GIL. Converts Python exceptions to std::runtime_error with their last line.
template <class Call>
auto in_python(const std::string& file, Call&& call) {
  const pybind11::gil_scoped_acquire gil;
  try {
    return call();
  } catch (pybind11::error_already_set& error) {
    throw std::runtime_error(last_line(error, file));
  }
}

/// An object that C++ owns, possibly beyond the end of the interpreter.
class HeldObject {
 public:
  explicit HeldObject(pybind11::object object) : object_(std::move(object)) {}
  HeldObject(const HeldObject&) = delete;
  HeldObject& operator=(const HeldObject&) = delete;
  ~HeldObject() {
    if (Py_IsInitialized() == 0) {
      object_.release();
      return;
    }
    const pybind11::gil_scoped_acquire gil;
    object_ = pybind11::object();
  }
  const pybind11::object& operator*() const { return object_; }
  const pybind11::object* operator->() const { return &object_; }

 private:
  pybind11::object object_;
};

/// Returns a text as one line, whatever it contains.
std::string object_text(pybind11::handle text);
/// Returns the file of a class's module, and the first line of a text or None.
std::string file_of(pybind11::handle type);
std::string first_line(pybind11::handle text);

/// @param first name of the parameter before `settings`
/// @throws std::runtime_error with the place and the expected signature if `type(first, settings)` is no valid call
void check_constructor(pybind11::handle type, const std::string& first);
/// The same for a method, if the object has it. @param parameters "(self)" @param arguments number without self
void check_method(const pybind11::object& object, const char* method, const char* parameters, int arguments);

/// Returns arguments for Python classes. They are copies, because Python may keep them.
pybind11::object input_of(const Input& input, const Robot& robot);
/// Returns `type(site, settings)`, with settings in a form that refuses later calls.
pybind11::object with_settings(Settings& settings, const pybind11::handle& type, const pybind11::object& site);

/// Returns a reading that owns its numbers. @param columns numbers per row
pybind11::object reading_object(const Reading& reading, std::size_t columns);

/// Wraps a class with take(self, input, reading) and read(self, time) as a derived sensor type. Its attributes `id`,
/// `columns`, `ports`, `keys`, `rate`, `rows` and `covariance` are those of DerivedEntry.
/// @throws std::runtime_error for attributes of another type
DerivedEntry derived_entry_of(pybind11::handle type, const std::string& file);

/// Wraps the class as a kind of controller with its own name. Keeps the class for the rest of the program. Its objects
/// acquire the GIL in each call. Checks signatures when the first object is created.
/// @throws std::runtime_error for attributes of another type
ControllerEntry entry_of(pybind11::handle type);
/// The same for a model controller.
ModelEntry model_entry_of(pybind11::handle type);

}  // namespace sensorfarm::python
