#pragma once
// Controllers written in Python: a class with __init__(self, robot, settings) and step(self, input) -> (forward, left,
// turn). Optional: `rate` [Hz], `on_scans` and `stops_on_bumper` of the class, methods radio_range(), done() and
// error() (sensorfarm/controller.h).

#include <pybind11/pybind11.h>

#include <string>

#include "sensorfarm/controller.h"

namespace sensorfarm::python {

/// Adds Robot, SensorInfo, Input, Reading, Neighbour, Light and Settings, local to the library that calls it.
void add_controller_types(pybind11::module_& module);

/// "mine.py:12: ValueError: too fast", with the innermost line in `file`, else the innermost line. Needs the GIL.
std::string last_line(pybind11::error_already_set& error, const std::string& file);

/// "mine.py:12: " of a class, method or function; empty where its source is not at hand. Needs the GIL.
std::string place_of(pybind11::handle thing);

/// Arguments of Python classes, which are copies: Python may keep them.
pybind11::object input_of(const Input& input, const Robot& robot);
/// Hands `settings` to `use` in a form that refuses calls later on.
pybind11::object with_settings(Settings& settings, const pybind11::handle& type, const Robot& robot);

/// The class as a kind of controller, called by its own name. The class is kept for the rest of the program. Its
/// objects acquire the GIL in each call. Signatures are checked when the first object is made.
/// @throws std::runtime_error for attributes of another type
ControllerEntry entry_of(pybind11::handle type);

}  // namespace sensorfarm::python
