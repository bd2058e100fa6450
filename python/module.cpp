// sensorfarm._sensorfarm: sensorfarm/simulation.h for Python. Arrays are views of the farm's memory and keep it alive.

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <optional>

#include "python/controllers.h"
#include "python/dlpack.h"
#include "python/types.h"
#include "sensorfarm/device_worlds.h"
#include "sensorfarm/simulation.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

using Text = const std::string&;

/// Marks the farm as in use: one thread at a time, for all simulations of the process. A second thread is refused, not
/// queued, so that a controller that steps a simulation cannot deadlock.
class Use {
 public:
  Use() {
    if (busy().exchange(true))
      throw Error(
          "another call of a simulation has not ended; expected one thread at a time, and none by a controller");
  }
  ~Use() { busy() = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  static std::atomic<bool>& busy() {
    static std::atomic<bool> flag{false};
    return flag;
  }
};

/// Calls without the GIL.
template <class Call>
auto in_farm(Call&& call) {
  const py::gil_scoped_release no_gil;
  const Use use;
  return call();
}

struct PySimulation {
  PySimulation(Simulation made, bool views_writable) : farm(std::move(made)), writable(views_writable) {}
  PySimulation(PySimulation&&) noexcept = default;
  PySimulation& operator=(PySimulation&&) noexcept = default;
  /// A forked process cannot end threads that it does not have, so it keeps the memory.
  ~PySimulation() {
    if (process != getpid()) new Simulation(std::move(farm));
  }

  Simulation farm;
  bool writable;  ///< arrays are writable
  pid_t process = getpid();
};

/// Worlds on a device; arrays are copies.
struct PyDeviceWorlds {
  explicit PyDeviceWorlds(DeviceWorlds made) : farm(std::move(made)) {}
  PyDeviceWorlds(PyDeviceWorlds&&) noexcept = default;
  /// As for simulations.
  ~PyDeviceWorlds() {
    if (process != getpid()) new DeviceWorlds(std::move(farm));
  }

  DeviceWorlds farm;
  pid_t process = getpid();
};

/// Calls this simulation without the GIL.
template <class Owner, class Call>
auto in_farm(const Owner& s, Call&& call) {
  if (s.process != getpid())
    throw Error("this simulation was created before the process was forked; expected one that this process created");
  return in_farm(call);
}

std::vector<std::pair<std::string, std::string>> texts_of(const py::dict& settings) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const auto& [key, value] : settings) {
    const std::string text = py::str(value);
    texts.emplace_back(py::str(key), PyBool_Check(value.ptr()) ? (text == "True" ? "true" : "false") : text);
  }
  return texts;
}

/// Keyword options of the constructor, checked like Python's own arguments.
class Keywords {
 public:
  explicit Keywords(const py::kwargs& given) : left_(py::dict(given)) {}
  template <class Value>
  void read(const char* key, Value& value) {
    if (!left_.contains(key)) return;
    try {
      value = left_.attr("pop")(key).template cast<Value>();
    } catch (const py::cast_error&) {
      throw py::type_error(std::string("'") + key + "' has a value of another type; see help(sensorfarm.Simulation)");
    }
  }
  void read_settings(std::vector<std::pair<std::string, std::string>>& settings) {
    py::dict given;
    read("settings", given);
    settings = texts_of(given);
  }
  void finish() const {
    for (const auto& [key, value] : left_)
      throw py::type_error("'" + std::string(py::str(key)) +
                           "' is not an option of a simulation; see help(sensorfarm.Simulation)");
  }

 private:
  py::dict left_;
};

std::string controller_name(py::handle type);

Options options_of(Keywords& given) {
  Options options;
  py::object controller = py::str("");
  given.read("robots", options.robots), given.read("of", options.of), given.read("seed", options.seed);
  given.read("copies", options.copies), given.read("record_world", options.record_world);
  given.read("robot_from", options.robot_from), given.read("positioning", options.positioning);
  given.read("faults", options.faults);
  given.read("threads", options.threads), given.read("noise", options.noise);
  given.read("accuracy", options.accuracy), given.read("device", options.device), given.read("caster", options.caster);
  given.read("require_vulkan", options.require_vulkan);
  given.read("controller", controller), given.read_settings(options.settings);
  given.read("record", options.record), given.read("record_readings", options.record_readings);
  given.read("ranks", options.ranks), given.read("too_near_min", options.too_near_min);
  given.read("compression", options.compression);
  options.controller = controller_name(controller);
  if (options.controller.empty() && !options.settings.empty())
    throw py::value_error("'settings' are given without a controller");
  return options;
}

template <class Make>
PySimulation made(const py::kwargs& keywords, Make&& make) {
  Keywords given(keywords);
  const Options options = options_of(given);
  bool writable = false;
  given.read("writable", writable);
  given.finish();
  PySimulation s = in_farm([&] { return PySimulation(make(options), writable); });
  if (s.farm.ranks() > 1) py::module_::import("sensorfarm").attr("_end_all_by_errors")();
  return s;
}

/// Returns the name by which a simulation can use a class: "module.Class", with a number if another class has it.
std::string controller_name(py::handle controller) {
  if (PyType_Check(controller.ptr()) == 0) return py::str(controller);
  static std::map<PyObject*, std::string> names;  // the entries keep the classes alive
  static std::map<std::string, int> uses;
  const auto known = names.find(controller.ptr());
  if (known != names.end()) return known->second;
  if (!py::hasattr(controller, "step"))
    throw py::type_error(place_of(controller) + "'" + std::string(py::str(controller.attr("__name__"))) +
                         "' is not a controller: it has no method step(self, input)");
  ControllerEntry entry = entry_of(controller);
  entry.name = std::string(py::str(controller.attr("__module__"))) + "." + entry.name;
  if (const int number = ++uses[entry.name]; number > 1) entry.name += "#" + std::to_string(number);
  const std::string name = entry.name;
  add_controller(std::move(entry));
  return names[controller.ptr()] = name;
}

/// Makes a class with tick(self, model) available to `ctrl`. @param name nullopt: the name of the class
void add_model_class(py::handle controller, const std::optional<std::string>& name) {
  if (PyType_Check(controller.ptr()) == 0 || !py::hasattr(controller, "tick"))
    throw py::type_error(place_of(controller) + std::string(py::repr(controller)) +
                         " is not a controller of models; expected a class with a method tick(self, model)");
  ModelEntry entry = model_entry_of(controller);
  if (name) entry.name = *name;
  in_farm([&] { add_model_controller(std::move(entry)); });
}

/// Returns a view whose rows begin `stride` bytes apart.
py::array view(const PySimulation& s, const py::dtype& type, const void* data, std::vector<py::ssize_t> shape,
               std::size_t stride) {
  std::vector<py::ssize_t> strides(shape.size());
  py::ssize_t next = type.itemsize();
  for (std::size_t i = shape.size(); i-- > 1; next *= shape[i]) strides[i] = next;
  strides[0] = static_cast<py::ssize_t>(stride);
  auto* const kept = new std::shared_ptr<const void>(s.farm.memory());
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::shared_ptr<const void>*>(memory); });
  py::array array(type, std::move(shape), std::move(strides), data, owner);
  if (!s.writable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::ssize_t count(std::size_t n) { return static_cast<py::ssize_t>(n); }

template <class Row>
py::array rows(const PySimulation& s, std::span<const Row> data) {
  constexpr std::size_t kNumbers = sizeof(Row) / sizeof(double);
  return view(s, py::dtype::of<double>(), data.data(), {count(data.size()), count(kNumbers)}, sizeof(Row));
}

template <class Value>
py::array column(const PySimulation& s, std::span<const Value> data) {
  return view(s, py::dtype::of<Value>(), data.data(), {count(data.size())}, sizeof(Value));
}

py::array truth(const PySimulation& s, std::span<const std::uint8_t> data) {
  return view(s, py::dtype::of<bool>(), data.data(), {count(data.size())}, 1);
}

py::array values(const PySimulation& s, Text type) {
  const Readings r = s.farm.readings(type);
  std::vector<py::ssize_t> shape{count(r.sensors), count(r.elements)};
  if (r.columns > 1) shape.push_back(count(r.columns));
  return view(s, py::dtype::of<double>(), r.values, shape, r.stride * sizeof(double));
}

py::array hits(const PySimulation& s, Text type) {
  const Readings r = s.farm.readings(type);
  if (r.hits == nullptr) throw Error("a reading of type '" + type + "' has no hits; expected laser, lidar or camera");
  return view(s, py::dtype::of<std::uint32_t>(), r.hits, {count(r.sensors), count(r.elements)},
              r.hit_stride * sizeof(std::uint32_t));
}

py::array flags(const PySimulation& s, Text type) {
  const Readings r = s.farm.readings(type);
  return view(s, py::dtype::of<std::uint8_t>(), r.flags.data(), {count(r.sensors), count(r.elements)}, r.elements);
}

using Commands = py::array_t<double, py::array::c_style | py::array::forcecast>;

void step(PySimulation& s, const py::object& twists) {
  if (twists.is_none()) return in_farm(s, [&] { s.farm.step(); });
  const Commands commands = Commands::ensure(twists);
  if (!commands || commands.ndim() != 2 || commands.shape(1) != 3 || commands.shape(0) != count(s.farm.size()))
    throw py::value_error("twists have " +
                          (commands ? "the shape " + std::string(py::str(commands.attr("shape")))
                                    : std::string("elements that are not numbers")) +
                          "; expected (" + std::to_string(s.farm.size()) +
                          ", 3): forward [m/s], left [m/s], turn [rad/s] per row");
  static_assert(sizeof(Twist) == 3 * sizeof(double));
  const auto* const first = reinterpret_cast<const Twist*>(commands.data());
  in_farm(s, [&] { s.farm.step({first, s.farm.size()}); });
}

std::size_t add_robot(PySimulation& s, Text name, Text like, const Pose& pose, const py::object& controller,
                      const py::dict& settings) {
  NewRobot robot{name, like, pose, controller_name(controller)};
  robot.settings = texts_of(settings);
  if (robot.controller.empty() && !robot.settings.empty())
    throw py::value_error("'settings' are given without a controller");
  return in_farm(s, [&] { return s.farm.add_robot(robot); });
}

py::array image(const PySimulation& s, int width, int height, const std::optional<std::array<double, 4>>& view,
                std::size_t world) {
  auto* const made = new Image(in_farm(s, [&] { return s.farm.image({width, height, view}, world); }));
  const py::capsule owner(made, [](void* image) { delete static_cast<Image*>(image); });
  return py::array_t<std::uint8_t>({made->height, made->width, 3}, made->rgb.data(), owner);
}

void set_shape(PySimulation& s, std::size_t row, Text shape, Text color,
               const std::optional<std::array<double, 3>>& size) {
  in_farm(s, [&] { s.farm.set_shape(row, {shape, color, size}); });
}

/// Returns numbers per world and row; none for None. @param width of a row
template <class Owner>
Commands rows_of(const Owner& s, const py::object& given, const char* name, std::size_t worlds, std::size_t width) {
  if (given.is_none()) return {};
  Commands rows = Commands::ensure(given);
  const std::size_t robots = s.farm.robots().size();
  if (rows && static_cast<std::size_t>(rows.size()) == worlds * robots * width) return rows;
  throw py::value_error(
      std::string(name) + " have " +
      (rows ? "the shape " + std::string(py::str(rows.attr("shape"))) : std::string("elements that are not numbers")) +
      "; expected (" + std::to_string(worlds) + ", " + std::to_string(robots) +
      (width > 1 ? ", " + std::to_string(width) : "") + "), a row per world and row");
}

template <class Row>
std::span<const Row> as_rows(const Commands& rows) {
  return {reinterpret_cast<const Row*>(rows.data()),
          static_cast<std::size_t>(rows.size()) * sizeof(double) / sizeof(Row)};
}

template <class Owner>
void restart(Owner& s, const std::vector<std::uint32_t>& worlds, const std::vector<std::uint64_t>& seeds,
             const py::object& starts, const py::object& present, const py::object& sizes, const py::object& slip,
             const py::object& acceleration, const py::object& noise) {
  static_assert(sizeof(Pose) == 4 * sizeof(double) && sizeof(std::array<double, 3>) == 3 * sizeof(double));
  const auto rows = [&](const py::object& given, const char* name, std::size_t width) {
    return rows_of(s, given, name, worlds.size(), width);
  };
  const Commands poses = rows(starts, "starts", 4), shown = rows(present, "entries of 'present'", 1),
                 lengths = rows(sizes, "sizes", 3), slips = rows(slip, "slips", 1),
                 factors = rows(acceleration, "accelerations", 1), noises = rows(noise, "entries of 'noise'", 1);
  const WorldStarts given{as_rows<Pose>(poses),   as_rows<double>(shown),   as_rows<std::array<double, 3>>(lengths),
                          as_rows<double>(slips), as_rows<double>(factors), as_rows<double>(noises)};
  in_farm(s, [&] { s.farm.reset(worlds, seeds, given); });
}

/// Returns a view of an observation's memory. @param width 0: one number per agent
template <class Value>
py::array seen(const Observations& o, std::span<Value> data, std::size_t width, bool writable) {
  std::vector<py::ssize_t> shape{count(o.agents())};
  if (width > 0) shape.push_back(count(width));
  auto* const kept = new Observations(o);
  const py::capsule owner(kept, [](void* handle) { delete static_cast<Observations*>(handle); });
  py::array array(py::dtype::of<std::remove_const_t<Value>>(), std::move(shape), data.data(), owner);
  if (!writable) array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// Returns a DLPack capsule, which keeps the memory as an array does. Of DLPack's options only `copy` matters on the
/// host.
py::object exported(py::object array, const py::kwargs& options) {
  if (options.contains("copy") && py::cast<bool>(options["copy"])) array = array.attr("copy")();
  return array.attr("__dlpack__")();
}

void add_observations(py::module_& module) {
  using O = Observations;
  py::class_<O>(module, "Observations", "What a learner observes; written in place after each step and reset.")
      .def_property_readonly(
          "values", [](const O& o) { return seen(o, o.values(), o.columns(), false); },
          "(agents, columns) float32 in [-1, 1].")
      .def_property_readonly(
          "rows", [](const O& o) { return seen(o, o.rows(), 0, false); }, "(agents,): row of the agent's robot.")
      .def_property_readonly(
          "goals", [](const O& o) { return seen(o, o.goals(), 2, true); },
          "(agents, 2): x, y [m] of each goal; writable. NaN: none.")
      .def_property_readonly(
          "distances", [](const O& o) { return seen(o, o.distances(), 0, false); }, "(agents,) [m] to the goal.")
      .def_property_readonly(
          "progress", [](const O& o) { return seen(o, o.progress(), 0, false); },
          "(agents,) [m]: how much nearer the goal came in the last step.")
      .def_property_readonly(
          "ages", [](const O& o) { return seen(o, o.ages(), 0, false); }, "(agents,): steps since the world's start.")
      .def(
          "update", [](O& o) { in_farm([&] { o.update(); }); }, "Recomputes the values after goals have changed.")
      .def(
          "__dlpack__",
          [](const O& o, const py::kwargs& options) {
            return exported(seen(o, o.values(), o.columns(), true), options);  // NumPy exports writable arrays only
          },
          "`values` without a copy, for torch.from_dlpack(observations). Do not write to it.")
      .def(
          "__dlpack_device__", [](const O&) { return std::pair(1, 0); }, "The host.")
      .def("__len__", [](const O& o) { return o.agents(); });
}

void add_state(py::class_<PySimulation>& c) {
  c.def_property_readonly(
       "poses", [](const PySimulation& s) { return rows(s, s.farm.poses()); },
       "(robots, 4): x, y, z [m], yaw [rad] of the last tick.")
      .def_property_readonly(
          "poses7",
          [](const PySimulation& s) {
            const auto poses = s.farm.poses7();
            static_assert(sizeof(Pose7) == 7 * sizeof(double));
            return py::array_t<double>({count(poses.size()), py::ssize_t{7}}, &poses.data()->x);
          },
          "(robots, 7): x, y, z [m] and a unit quaternion w, x, y, z of the last tick; a copy.")
      .def_property_readonly(
          "velocities", [](const PySimulation& s) { return rows(s, s.farm.velocities()); },
          "(robots, 3): forward, left [m/s], turn [rad/s].")
      .def_property_readonly(
          "radii",
          [](const PySimulation& s) {
            return py::array_t<double>(count(s.farm.radii().size()), s.farm.radii().data());
          },
          "(rows,) [m]: radius of the circle about its origin that contains the body; changes with its size.")
      .def_property_readonly(
          "contacts", [](const PySimulation& s) { return truth(s, s.farm.contacts()); },
          "(robots,): stopped by a wall or a robot.")
      .def_property_readonly(
          "done", [](const PySimulation& s) { return truth(s, s.farm.done()); }, "(robots,): the controller is done.")
      .def_property_readonly(
          "present", [](const PySimulation& s) { return truth(s, s.farm.present()); },
          "(robots,): the robot has not been removed.")
      .def_property_readonly(
          "robots", [](const PySimulation& s) { return s.farm.robots(); }, "Of each row, at the start.")
      .def_property_readonly(
          "shapes", [](const PySimulation& s) { return s.farm.shapes(); }, "Names of the shapes of this world.")
      .def_property_readonly(
          "types", [](const PySimulation& s) { return s.farm.types(); }, "Sensor types of this world.")
      .def_property_readonly(
          "models", [](const PySimulation& s) { return s.farm.models(); }, "Names, by the numbers in hits().")
      .def_property_readonly(
          "copies", [](const PySimulation& s) { return s.farm.copies(); }, "Number of worlds.")
      .def_property_readonly(
          "interval", [](const PySimulation& s) { return s.farm.interval(); }, "[s] of a tick.")
      .def_property_readonly(
          "time", [](const PySimulation& s) { return s.farm.time(); }, "[s] of the last tick, of world 0.")
      .def_property_readonly(
          "tick", [](const PySimulation& s) { return s.farm.tick(); }, "Number of the last tick, from 0.")
      .def_property_readonly(
          "hash", [](const PySimulation& s) { return s.farm.hash(); },
          "Hash of all readings so far, as of `sensorfarm run`.")
      .def_property_readonly(
          "rank", [](const PySimulation& s) { return s.farm.rank(); }, "Number of this process, below `ranks`.")
      .def_property_readonly(
          "ranks", [](const PySimulation& s) { return s.farm.ranks(); }, "Processes that share the fleet.")
      .def_property_readonly(
          "owned", [](const PySimulation& s) { return truth(s, s.farm.owned()); },
          "(robots,): this rank commands the robot and has its readings.")
      .def_property_readonly(
          "description", [](const PySimulation& s) { return s.farm.description(); }, "Device and caster, in one line.")
      .def_property_readonly(
          "warnings", [](const PySimulation& s) { return s.farm.warnings(); },
          "Warnings about the world file and the device.")
      .def("__len__", [](const PySimulation& s) { return s.farm.size(); });
}

void add_readings(py::class_<PySimulation>& c) {
  const py::arg type("type");
  c.def("readings", &values, type,
        "(sensors, elements[, columns]): the newest reading of each sensor; shorter ones end in NaN.")
      .def(
          "_image_sizes", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).image_sizes); }, type)
      .def(
          "_widths", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).widths); }, type)
      .def("hits", &hits, type, "(sensors, beams or pixels): number of the model that each one met, FLOOR or NONE.")
      .def("flags", &flags, type, "(sensors, elements): 0 where a stated bound holds.")
      .def(
          "bounds", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).bounds); }, type,
          "(sensors,): largest error of the first column; infinite where none is stated, as of noisy sensors.")
      .def(
          "bound_without_noise",
          [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).bound_without_noise); }, type,
          "(sensors,): the same before noise was added.")
      .def(
          "sigma", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).sigma); }, type,
          "(sensors,): largest standard deviation of the first column's noise; 0: none; infinite: not known.")
      .def(
          "times", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).times); }, type,
          "(sensors,) [s] of the measurement; NaN before the first.")
      .def(
          "rows", [](const PySimulation& s, Text t) { return column(s, s.farm.readings(t).robots); }, type,
          "(sensors,): row of the sensor's robot.")
      .def(
          "fresh", [](const PySimulation& s, Text t) { return truth(s, s.farm.readings(t).fresh); }, type,
          "(sensors,): delivered in the last step.");
}

void add_simulation(py::module_& module) {
  py::class_<PySimulation> c(module, "Simulation",
                             "A simulated fleet. Arrays are views, valid until the next step, put or reset.");
  c.def(
       py::init([](Text world, const py::kwargs& options) {
         return made(options, [&](const Options& given) { return Simulation(world, given); });
       }),
       py::arg("world"),
       "world: a file; options: robots=0, of='', robot_from='', seed=1, copies=1, threads=0, noise=True, accuracy='', "
       "device='', caster='auto', "
       "require_vulkan=False, "
       "controller='', settings={}, record='', record_readings=False, record_world=0, ranks=False, too_near_min=False, "
       "compression='zstd', positioning='', faults='', writable=False (docs/python.md)")
      .def_static(
          "from_text",
          [](Text text, Text name, const py::kwargs& options) {
            return made(options, [&](const Options& given) { return Simulation::from_text(text, given, name); });
          },
          py::arg("text"), py::arg("name") = "given.world")
      .def("step", &step, py::arg("twists") = py::none(),
           "One tick. twists: (robots, 3) of forward, left [m/s], turn [rad/s]; None: unchanged.")
      .def(
          "reset",
          [](PySimulation& s, std::optional<std::uint64_t> seed) {
            in_farm(s, [&] { seed ? s.farm.reset(*seed) : s.farm.reset(); });
          },
          py::arg("seed") = py::none())
      .def("restart", &restart<PySimulation>, py::arg("worlds"), py::arg("seeds"), py::arg("starts") = py::none(),
           py::kw_only(), py::arg("present") = py::none(), py::arg("sizes") = py::none(), py::arg("slip") = py::none(),
           py::arg("acceleration") = py::none(), py::arg("noise") = py::none(),
           "Restarts some of several worlds. seeds: one per world. starts: (worlds, rows, 4) poses; sizes: (worlds, "
           "rows, 3) [m]; others: (worlds, rows). None, and NaN (in x): those of the seeds.")
      .def(
          "observe",
          [](PySimulation& s, Text sensor, std::uint32_t every, bool speeds, double goal_reach, std::uint32_t stack) {
            return in_farm(s, [&] { return s.farm.observe({sensor, every, speeds, goal_reach, stack}); });
          },
          py::arg("sensor") = "laser", py::kw_only(), py::arg("every") = 1, py::arg("speeds") = true,
          py::arg("goal_reach") = 0.0, py::arg("stack") = 1,
          "Returns Observations that are written from now on: every k-th element of the readings over their limits, "
          "speeds over theirs, the goal, and `stack` of these, the newest first.")
      .def(
          "hash_of", [](const PySimulation& s, std::size_t world) { return s.farm.hash(world); }, py::arg("world"),
          "Hash of the readings of one of several worlds, since its start.")
      .def(
          "time_of", [](const PySimulation& s, std::size_t world) { return s.farm.time(world); }, py::arg("world"),
          "[s] of the last tick, of one of several worlds.")
      .def(
          "put", [](PySimulation& s, std::size_t row, const Pose& pose) { in_farm(s, [&] { s.farm.put(row, pose); }); },
          py::arg("row"), py::arg("pose"), "Places a robot at (x, y, z [m], yaw [rad]), at rest.")
      .def(
          "put",
          [](PySimulation& s, std::size_t row, const std::array<double, 7>& p) {
            in_farm(s, [&] { s.farm.put7(row, {p[0], p[1], p[2], p[3], p[4], p[5], p[6]}); });
          },
          py::arg("row"), py::arg("pose"), "Places and tilts it: x, y, z [m] and a unit quaternion w, x, y, z.")
      .def("add_robot", &add_robot, py::arg("name"), py::arg("like"), py::arg("pose"), py::kw_only(),
           py::arg("controller") = "", py::arg("settings") = py::dict(),
           "Adds a copy of a robot at (x, y, z [m], yaw [rad]), at rest, and returns its row.")
      .def(
          "remove_robot", [](PySimulation& s, std::size_t row) { in_farm(s, [&] { s.farm.remove_robot(row); }); },
          py::arg("row"), "Removes a robot from the world; its row remains.")
      .def("set_shape", &set_shape, py::arg("row"), py::arg("shape") = "", py::kw_only(), py::arg("color") = "",
           py::arg("size") = py::none(), "Changes the shape, colour or size (x, y, z) [m] of a robot or tag.")
      .def(
          "set_lane", [](PySimulation& s, Text lane, Text use) { in_farm(s, [&] { s.farm.set_lane(lane, use); }); },
          py::arg("lane"), py::arg("use"), "Requests the use of a lane: open, closed, reversed, turn, left or right.")
      .def(
          "draw",
          [](const PySimulation& s, Text file, std::size_t world) { in_farm(s, [&] { s.farm.draw(file, world); }); },
          py::arg("file"), py::kw_only(), py::arg("world") = 0,
          "Writes a picture of the world at this time: PNG, SVG or PDF by its suffix.")
      .def("image", &image, py::arg("width") = 640, py::arg("height") = 480, py::arg("view") = py::none(),
           py::kw_only(), py::arg("world") = 0,
           "(height, width, 3) uint8: the world from above at this time; shows at least view = (x_min, y_min, x_max, "
           "y_max) [m].")
      .def("finish_recording", [](PySimulation& s) { in_farm(s, [&] { s.farm.finish_recording(); }); });
  add_state(c), add_readings(c);
}

/// Returns a copy with an axis of worlds. @param width numbers of an entry; 0: the entries are numbers
template <class Value, class Row>
py::array by_world(const PyDeviceWorlds& s, std::span<const Row> (DeviceWorlds::*read)() const, std::size_t width) {
  const std::span<const Row> data = in_farm(s, [&] { return (s.farm.*read)(); });
  const std::size_t entries = data.size_bytes() / sizeof(Value) / std::max<std::size_t>(width, 1);
  std::vector<py::ssize_t> shape{count(s.farm.copies()), count(entries / s.farm.copies())};
  if (width > 0) shape.push_back(count(width));
  return py::array(py::dtype::of<Value>(), std::move(shape), data.data());
}

py::array ranges_by_world(const PyDeviceWorlds& s) {
  const Readings r = in_farm(s, [&] { return s.farm.readings(); });
  const std::size_t worlds = s.farm.copies();
  return py::array(py::dtype::of<double>(), {count(worlds), count(r.sensors / worlds), count(r.elements)}, r.values);
}

/// Memory of worlds on a device, with an axis of worlds.
struct PyDeviceArray {
  DeviceArray memory;
  std::vector<std::int64_t> shape, strides;  ///< [elements]

  std::size_t bytes() const { return memory.single ? sizeof(float) : sizeof(double); }
  /// None for CUDA's memory.
  py::object array() const {
    if (memory.cuda >= 0) return py::none();
    auto* const kept = new std::shared_ptr<const void>(memory.memory);
    static const pid_t process = getpid();  // a forked one keeps the memory, as for simulations
    const py::capsule owner(kept, [](void* held) {
      if (process == getpid()) delete static_cast<std::shared_ptr<const void>*>(held);
    });
    std::vector<py::ssize_t> steps;
    for (const std::int64_t stride : strides) steps.push_back(stride * count(bytes()));
    return py::array(memory.single ? py::dtype::of<float>() : py::dtype::of<double>(),
                     std::vector<py::ssize_t>(shape.begin(), shape.end()), steps, memory.data, owner);
  }
  py::object exported_to(const py::kwargs& options) const {
    if (memory.cuda < 0) return exported(array(), options);
    if (options.contains("copy") && py::cast<bool>(py::bool_(options["copy"])))
      throw py::buffer_error("memory of CUDA is shared without a copy; expected copy=False");
    return cuda_capsule(memory.data, memory.cuda, static_cast<int>(8 * bytes()), shape, strides, memory.memory);
  }
};

/// @param rows of a world, the first ones; 0: all
PyDeviceArray shared_by_world(PyDeviceWorlds& s, DeviceTable table, std::size_t rows) {
  PyDeviceArray made{in_farm(s, [&] { return s.farm.array(table); }), {}, {}};
  const std::size_t of_world = made.memory.rows / s.farm.copies();
  made.shape = {count(s.farm.copies()), count(rows > 0 ? rows : of_world)};
  made.strides = {count(of_world * made.memory.stride), count(made.memory.stride)};
  if (table == DeviceTable::observations || table == DeviceTable::commands)
    made.shape.push_back(count(made.memory.columns)), made.strides.push_back(1);
  return made;
}

void add_device_arrays(py::module_& module) {
  using A = PyDeviceArray;
  py::class_<A>(module, "DeviceArray", "Memory of DeviceWorlds, for torch.from_dlpack and numpy.from_dlpack.")
      .def_property_readonly("array", &A::array, "The same memory as an array of NumPy; None for memory of CUDA.")
      .def_property_readonly(
          "copied", [](const A& a) { return a.memory.copied; }, "It is the host's copy of the device's memory.")
      .def("__dlpack__", &A::exported_to, "The memory, which it keeps.")
      .def(
          "__dlpack_device__",
          [](const A& a) { return a.memory.cuda < 0 ? std::pair(kDlHost, 0) : std::pair(kDlCuda, a.memory.cuda); },
          "The host, or a device of CUDA.");
  py::enum_<DeviceTable>(module, "_DeviceTable")
      .value("observations", DeviceTable::observations)
      .value("commands", DeviceTable::commands)
      .value("distances", DeviceTable::distances)
      .value("progress", DeviceTable::progress);
}

PyDeviceWorlds made_on_device(Text world, const std::optional<std::string>& text, const py::kwargs& keywords) {
  Keywords given(keywords);
  const Options options = options_of(given);
  given.finish();
  return in_farm([&] {
    return PyDeviceWorlds(text ? DeviceWorlds::from_text(*text, options, world) : DeviceWorlds(world, options));
  });
}

/// The base of sensorfarm.DeviceWorlds (sensorfarm/worlds.py).
void add_device_worlds(py::module_& module) {
  using W = PyDeviceWorlds;
  py::class_<W>(module, "_DeviceWorlds")
      .def(py::init(&made_on_device), py::arg("world"), py::arg("text") = py::none())
      .def_property_readonly("robots", [](const W& s) { return s.farm.robots(); })
      .def_property_readonly("interval", [](const W& s) { return s.farm.interval(); })
      .def("step",
           [](W& s, const py::object& given) {
             const Commands commands = rows_of(s, given, "commands", s.farm.copies(), 3);
             in_farm(s, [&] { s.farm.step(as_rows<Twist>(commands)); });
           })
      .def("restart", &restart<W>, py::arg("worlds"), py::arg("seeds"), py::arg("starts"), py::kw_only(),
           py::arg("present"), py::arg("sizes"), py::arg("slip"), py::arg("acceleration"), py::arg("noise"))
      .def("poses", [](const W& s) { return by_world<double>(s, &DeviceWorlds::poses, 4); })
      .def("velocities", [](const W& s) { return by_world<double>(s, &DeviceWorlds::velocities, 3); })
      .def("contacts", [](const W& s) { return by_world<bool>(s, &DeviceWorlds::contacts, 0); })
      .def("readings", &ranges_by_world)
      .def(
          "observe",
          [](W& s, Text sensor, std::uint32_t every, bool speeds, double goal_reach, std::uint32_t stack) {
            in_farm(s, [&] { s.farm.observe({sensor, every, speeds, goal_reach, stack}); });
          },
          py::arg("sensor") = "laser", py::kw_only(), py::arg("every") = 1, py::arg("speeds") = true,
          py::arg("goal_reach") = 0.0, py::arg("stack") = 1)
      .def("set_goals",
           [](W& s, const Commands& goals) { in_farm(s, [&] { s.farm.set_goals(as_rows<double>(goals)); }); })
      .def("observations", [](const W& s) { return by_world<float>(s, &DeviceWorlds::observations, s.farm.columns()); })
      .def("shared", &shared_by_world)
      .def("update", [](W& s) { in_farm(s, [&] { s.farm.update(); }); })
      .def("distances", [](const W& s) { return by_world<double>(s, &DeviceWorlds::distances, 0); })
      .def("progress", [](const W& s) { return by_world<double>(s, &DeviceWorlds::progress, 0); });
}

}  // namespace

PYBIND11_MODULE(_sensorfarm, module) {
  py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
  py::register_exception<DeviceError>(module, "DeviceError", module.attr("Error"));
  module.attr("NONE") = kNone, module.attr("FLOOR") = kFloor;
  add_controller_types(module);
  add_observations(module);
  add_simulation(module);
  add_device_arrays(module);
  add_device_worlds(module);
  module.def("_abort_ranks", &abort_ranks);
  module.def("add_model_controller", &add_model_class, py::arg("controller"), py::arg("name") = py::none());
  module.def(
      "load_plugin", [](Text file) { in_farm([&] { load_plugin(file); }); }, py::arg("file"));
}

}  // namespace sensorfarm::python
