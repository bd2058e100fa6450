#pragma once
// Controllers and derived sensors written in Python. A controller is a class with __init__(self, robot, settings) and
// step(self, input) -> (forward, left, turn). Optional: class attributes `rate` [Hz], `on_scans` and `stops_on_bumper`,
// methods radio_range(), done() and error() (sensorfarm/controller.h).

#include <pybind11/pybind11.h>

#include <string>

#include "sensorfarm/controller.h"
#include "sensorfarm/derived.h"

namespace sensorfarm::python {

/// Adds Robot, SensorInfo, Input, Reading, Neighbour, Light and Settings, local to the library that calls this.
void add_controller_types(pybind11::module_& module);

/// Returns "mine.py:12: ValueError: too fast" with the innermost line in `file`, or the innermost line if there is
/// none. Requires the GIL.
std::string last_line(pybind11::error_already_set& error, const std::string& file);

/// Returns "mine.py:12: " for a class, method or function; empty if its source is not available. Requires the GIL.
std::string place_of(pybind11::handle thing);

/// Returns arguments for Python classes. They are copies, because Python may keep them.
pybind11::object input_of(const Input& input, const Robot& robot);
/// Passes `settings` to `use` in a form that refuses later calls.
pybind11::object with_settings(Settings& settings, const pybind11::handle& type, const Robot& robot);

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

}  // namespace sensorfarm::python
