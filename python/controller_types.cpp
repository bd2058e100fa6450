// The types of sensorfarm/controller.h in Python.

#include <algorithm>
#include <limits>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A reading that owns its values.
struct OwnedReading {
  std::string type;
  std::uint32_t number = 0;
  double time = 0.0;
  Pose X_WS;
  py::array_t<double> values;
  py::object hits;
  double bound = 0.0, bound_without_noise = 0.0, sigma = 0.0;
  py::array_t<std::uint8_t> flags;
};

struct OwnedInput {
  double time = 0.0;
  Pose pose;
  Twist velocity;
  py::list readings = py::list();
  bool contact = false, started = true;
  py::list others = py::list(), lights = py::list();
};

struct OwnedLight {
  std::string name;
  Pose pose;
  const char* state = "dark";
  double left = 0.0;
};

/// Settings during the call of __init__; null afterwards.
struct LentSettings {
  Settings* settings = nullptr;
  template <class Read>
  auto read(Read&& from) const {
    if (settings == nullptr) throw py::value_error("settings can be read in __init__ only");
    try {
      return from(*settings);
    } catch (const std::exception& error) {
      throw py::value_error(error.what());
    }
  }
};

std::size_t columns_of(const Robot& robot, const Reading& reading) {
  for (const SensorInfo& sensor : robot.sensors)
    if (sensor.number == reading.number && sensor.type == reading.type) return sensor.columns.size();
  return 1;
}

OwnedReading owned(const Reading& reading, std::size_t columns) {
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(reading.values.size())};
  if (columns > 1) shape = {shape[0] / static_cast<py::ssize_t>(columns), static_cast<py::ssize_t>(columns)};
  py::array_t<std::uint8_t> flags(shape[0]);
  std::fill_n(flags.mutable_data(), flags.size(), std::uint8_t{0});
  std::copy(reading.flags.begin(), reading.flags.end(), flags.mutable_data());
  py::object hits = py::none();
  if (!reading.hits.empty())
    hits = py::array_t<std::uint32_t>(static_cast<py::ssize_t>(reading.hits.size()), reading.hits.data());
  return {std::string(reading.type),
          reading.number,
          reading.time,
          reading.X_WS,
          py::array_t<double>(shape, reading.values.data()),
          std::move(hits),
          reading.bound,
          reading.bound_without_noise,
          reading.sigma,
          std::move(flags)};
}

const char* word_of(LightState state) {
  constexpr const char* kWords[] = {"dark", "red", "yellow", "green", "flashing_red", "flashing_yellow"};
  return kWords[static_cast<std::size_t>(state)];
}

py::object newest(const OwnedInput& input, const std::string& type, std::uint32_t number) {
  for (const py::handle one : input.readings) {
    const auto& reading = one.cast<const OwnedReading&>();
    if (reading.number == number && reading.type == type) return py::reinterpret_borrow<py::object>(one);
  }
  return py::none();
}

void add_robot(py::module_& module) {
  py::class_<SensorInfo>(module, "SensorInfo", py::module_local(), "One sensor of a robot.")
      .def_readonly("type", &SensorInfo::type)
      .def_readonly("number", &SensorInfo::number)
      .def_readonly("name", &SensorInfo::name)
      .def_readonly("X_RS", &SensorInfo::X_RS)
      .def_readonly("rate", &SensorInfo::rate)
      .def_readonly("elements", &SensorInfo::elements)
      .def_readonly("columns", &SensorInfo::columns)
      .def_readonly("limit", &SensorInfo::limit)
      .def_readonly("bearings", &SensorInfo::bearings);
  py::class_<Robot>(module, "Robot", py::module_local(), "A robot or tag at the start: metres, radians, m/s, rad/s.")
      .def_readonly("name", &Robot::name)
      .def_readonly("id", &Robot::id)
      .def_readonly("row", &Robot::row)
      .def_readonly("pose", &Robot::pose)
      .def_readonly("radius", &Robot::radius)
      .def_readonly("max_forward", &Robot::max_forward)
      .def_readonly("max_turn", &Robot::max_turn)
      .def_readonly("sensors", &Robot::sensors)
      .def_readonly("seed", &Robot::seed)
      .def_readonly("world", &Robot::world);
}

void add_input(py::module_& module) {
  py::class_<OwnedReading>(module, "Reading", py::module_local(), "One reading of one sensor.")
      .def_readonly("type", &OwnedReading::type)
      .def_readonly("number", &OwnedReading::number)
      .def_readonly("time", &OwnedReading::time)
      .def_readonly("X_WS", &OwnedReading::X_WS)
      .def_readonly("values", &OwnedReading::values)
      .def_readonly("hits", &OwnedReading::hits)
      .def_readonly("bound", &OwnedReading::bound)
      .def_readonly("bound_without_noise", &OwnedReading::bound_without_noise)
      .def_readonly("sigma", &OwnedReading::sigma)
      .def_readonly("flags", &OwnedReading::flags);
  py::class_<Neighbour>(module, "Neighbour", py::module_local(), "Another robot, by its V2V broadcasts.")
      .def_readonly("id", &Neighbour::id)
      .def_readonly("pose", &Neighbour::pose)
      .def_readonly("velocity", &Neighbour::velocity)
      .def_property_readonly("follows", [](const Neighbour& n) {
        return n.follows == kNone ? py::object(py::none()) : py::object(py::int_(n.follows));
      });
  py::class_<OwnedLight>(module, "Light", py::module_local(), "One traffic light.")
      .def_readonly("name", &OwnedLight::name)
      .def_readonly("pose", &OwnedLight::pose)
      .def_readonly("state", &OwnedLight::state)
      .def_readonly("left", &OwnedLight::left);
  py::class_<OwnedInput>(module, "Input", py::module_local(),
                         "The input of a controller's step: all that is known to its robot.")
      .def_readonly("time", &OwnedInput::time)
      .def_readonly("pose", &OwnedInput::pose)
      .def_readonly("velocity", &OwnedInput::velocity)
      .def_readonly("readings", &OwnedInput::readings)
      .def_readonly("contact", &OwnedInput::contact)
      .def_readonly("started", &OwnedInput::started)
      .def_readonly("others", &OwnedInput::others)
      .def_readonly("lights", &OwnedInput::lights)
      .def("newest", &newest, py::arg("type"), py::arg("number") = 0);
}

void add_settings(py::module_& module) {
  using Given = const LentSettings&;
  using Key = const std::string&;
  const py::arg key("key"), fallback("fallback");
  const auto number = [](Given s, Key k, double f, double least, double most) {
    return s.read([&](Settings& from) { return from.number(k, f, least, most); });
  };
  const auto flag = [](Given s, Key k, bool f) { return s.read([&](Settings& from) { return from.flag(k, f); }); };
  const auto text = [](Given s, Key k, Key f) { return s.read([&](Settings& from) { return from.text(k, f); }); };
  const auto numbers = [](Given s, Key k, const std::vector<double>& f) {
    return s.read([&](Settings& from) { return from.numbers(k, f); });
  };
  py::class_<LentSettings>(module, "Settings", py::module_local(), "Settings by key; each must be read in __init__.")
      .def("number", number, key, fallback, py::arg("least") = -kInfinity, py::arg("most") = kInfinity)
      .def("flag", flag, key, fallback)
      .def("text", text, key, fallback)
      .def("numbers", numbers, key, fallback);
}

}  // namespace

void add_controller_types(py::module_& module) {
  module.attr("Pose") = pose_type(), module.attr("Twist") = twist_type();
  add_robot(module), add_input(module), add_settings(module), add_model_types(module);
}

py::object reading_object(const Reading& reading, std::size_t columns) { return py::cast(owned(reading, columns)); }

py::object input_of(const Input& input, const Robot& robot) {
  OwnedInput own{.time = input.time, .pose = input.pose, .velocity = input.velocity};
  own.contact = input.contact, own.started = input.started;
  for (const Reading& reading : input.readings) own.readings.append(owned(reading, columns_of(robot, reading)));
  for (const Neighbour& other : input.others) own.others.append(other);
  for (const Light& light : input.lights)
    own.lights.append(OwnedLight{std::string(light.name), light.pose, word_of(light.state), light.left});
  return py::cast(std::move(own));
}

py::object with_settings(Settings& settings, const py::handle& type, const py::object& site) {
  const py::object lent = py::cast(LentSettings{&settings});
  struct Return {
    LentSettings& lent;
    ~Return() { lent.settings = nullptr; }
  } const give_back{lent.cast<LentSettings&>()};
  return type(site, lent);
}

}  // namespace sensorfarm::python
