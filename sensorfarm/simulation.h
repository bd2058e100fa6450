#pragma once
// A simulated fleet that your program steps:
//
//   sensorfarm::Simulation simulation("worlds/cave.world", {.robots = 50});
//   std::vector<sensorfarm::Twist> commands(simulation.size());
//   for (int tick = 0; tick < 100; ++tick) {
//     const sensorfarm::Readings scans = simulation.readings("laser");
//     for (std::size_t i = 0; i < scans.sensors; ++i) commands[scans.robots[i]] = drive(scans.row(i));
//     simulation.step(commands);
//   }
//
// Link with libsensorfarm (CMake: find_package(sensorfarm), sensorfarm::sensorfarm).

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sensorfarm/controller.h"
#include "sensorfarm/derived.h"
#include "sensorfarm/model.h"
#include "sensorfarm/observations.h"
#include "sensorfarm/sensor.h"

namespace sensorfarm {

/// An error that the user can correct. The message is one line, with file and line number if available.
class SENSORFARM_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// No usable Vulkan device, although one was requested. The message is one line with every device and the reason why it
/// was refused.
class SENSORFARM_API DeviceError : public Error {
 public:
  using Error::Error;
};

struct Options {
  std::uint32_t robots = 0;  ///< clones of one robot at free poses, replacing the world's robots; 0: keeps the world's
                             ///< robots
  std::string of;            ///< robot to clone; empty: the first robot with sensors
  std::uint64_t seed = 1;    ///< seed of poses, noise and controllers
  /// Simulates that many worlds at once, which share walls and settings. World k has seed + k and gives the bytes of a
  /// simulation of that world alone. All arrays have the rows of world 0, then those of world 1, and so on. Not with
  /// `record`, `ranks`, `positioning` and `faults`.
  std::uint32_t copies = 1;
  unsigned threads = 0;  ///< 0: all cores. The results do not depend on it
  bool noise = true;     ///< false: no noise, overriding the world file
  std::string accuracy;  ///< accuracy mode of all sensors (docs/accuracy.md); empty: as set in the world file
  std::string device;  ///< row or part of the name of a Vulkan device, or "host" for none, with the same bytes; empty:
                       ///< the best device, or the host if none is usable (as `warnings` states)
  std::string caster = "auto";  ///< "auto" or a name of `sensorfarm run --caster` (docs/accuracy.md#casters), such as
                                ///< "host" or "reference"
  /// Controller of all robots, by name or file. Empty: each robot runs the `ctrl` of its world file, and commands drive
  /// robots without one. "none": commands drive all robots.
  std::string controller;
  std::vector<std::pair<std::string, std::string>> settings;  ///< settings of that controller
  std::string record;                                         ///< folder of a recording (run.mcap); empty: none
  bool record_readings = false;  ///< record readings too, not only the states from which they can be computed
  /// Number of the world that is recorded, of several: as that of a simulation of it alone. The recording ends when
  /// this world restarts.
  std::uint32_t record_world = 0;
  /// Shares the fleet among processes started by mpirun (docs/cluster.md). Each process has the readings of its own
  /// robots only, and commands these; it has all other data of the whole fleet. All processes make the same calls with
  /// the same arguments, except commands.
  bool ranks = false;
  bool require_vulkan = false;       ///< throw DeviceError instead of using the host if no Vulkan device is usable
  bool too_near_min = false;         ///< recorded ranges of surfaces that are too near are range_min, not -infinity
  std::string compression = "zstd";  ///< compression of the recording: "zstd", or "none", with which a killed process
                                     ///< loses no tick
  /// "FILE:NAME": the robot NAME of a world file, or the robot type NAME that it defines. Used for a world without
  /// robots (a ROS map), or as the robot to clone. FILE is found in the same way as worlds. Empty: the default robot,
  /// or `of`.
  std::string robot_from;
  /// Simulates a positioning system for robots that localize themselves: keys of a scenario's table [positioning], one
  /// per line, such as "rate = 10\nposition_sigma = 0.01" (docs/scenarios.md). Empty: none.
  std::string positioning;
  /// Faults of sensors: [[fault]] tables of a scenario (docs/scenarios.md), such as
  /// "[[fault]]\nrobot = '*'\nsensor = 'gyro'\nkind = 'stuck'\nfrom = 10". Empty: none. Not with `ranks`.
  std::string faults;
};

/// The newest readings of all sensors of one type, as one table with a row per sensor. A view: valid until the next
/// step, put, add_robot or reset of its simulation. Simulation::memory keeps the memory alive for longer.
struct Readings {
  std::string_view type;
  std::size_t sensors = 0;              ///< rows: by robot, then in the order of the world file
  std::size_t elements = 0;             ///< elements of the longest reading: beams of a laser; shorter readings are
                                        ///< padded with NaN
  std::size_t columns = 1;              ///< numbers per element
  const double* values = nullptr;       ///< element by element, within an element column by column
  std::size_t stride = 0;               ///< distance between rows, in numbers; >= elements * columns
  const std::uint32_t* hits = nullptr;  ///< indices of the models that beams or pixels meet, kFloor or kNone; null for
                                        ///< other types than laser, lidar and camera
  std::size_t hit_stride = 0;           ///< distance between rows
  std::span<const std::uint32_t> robots;  ///< per row: the row of its robot in Simulation::poses
  std::span<const std::uint32_t> widths;  ///< per row: its numbers per element, the first columns; the others are NaN
  std::span<const double> times;          ///< [s] per row: time of the measurement; NaN before the first
  std::span<const double> bounds;         ///< per row: largest error of the first column, as in Reading::bound
  std::span<const double> bound_without_noise;  ///< per row, as in Reading
  std::span<const double> sigma;                ///< per row, as in Reading
  std::span<const std::uint8_t> fresh;          ///< per row: 1 if it was delivered in the last step
  std::span<const std::uint8_t> flags;          ///< sensors * elements: 0 if a stated bound holds (docs/accuracy.md)
  std::span<const std::uint32_t> image_sizes;   ///< two per row, of cameras: width and height [px]. Their elements are
                                                ///< pixels row by row from the top left. Empty for other types

  std::span<const double> row(std::size_t i) const { return {values + i * stride, elements * columns}; }
  std::span<const std::uint32_t> hits_of(std::size_t i) const { return {hits + i * hit_stride, elements}; }
};

/// A pose in six degrees of freedom in the world frame. Level robots have qx and qy of 0.
struct Pose7 {
  double x = 0.0, y = 0.0, z = 0.0;              ///< [m]
  double w = 1.0, qx = 0.0, qy = 0.0, qz = 0.0;  ///< unit quaternion of the body's orientation
};

/// A robot that joins a simulation.
struct NewRobot {
  std::string name;        ///< 1 to 64 letters, digits or '_', not beginning with a digit; not the name of another
                           ///< model of the world
  std::string like;        ///< robot of the world to copy, or the word of its type
  Pose pose;               ///< finite; its height is that of the original
  std::string controller;  ///< controller by name or file; empty: commands drive it
  std::vector<std::pair<std::string, std::string>> settings = {};  ///< settings of that controller
};

/// A change of an object or robot. What is not given remains, except that a shape brings its own size and colour.
struct ShapeChange {
  std::string shape = {};                          ///< one of Simulation::shapes(), or "original"; empty: unchanged
  std::string color = {};                          ///< X11 name or "#RRGGBB"; empty: unchanged
  std::optional<std::array<double, 3>> size = {};  ///< [m] x, y, z in (0, 1000] each
};

/// How worlds start, where it is not what their seeds choose. Each span is empty, or has an entry per row of the given
/// worlds in turn; NaN leaves the choice to the seed (or, without a random key, to the world file).
struct WorldStarts {
  std::span<const Pose> poses = {};                   ///< NaN in x
  std::span<const double> present = {};               ///< 0 or 1; robots cannot be missing
  std::span<const std::array<double, 3>> sizes = {};  ///< [m] x, y, z in (0, 1000] each, NaN in x; of objects with an
                                                      ///< outline, but without a magnet or a mark for fiducial finders
  std::span<const double> slip = {};          ///< in [0, 0.9]: part of its wheels' way that a robot does not advance
  std::span<const double> acceleration = {};  ///< in [0.01, 1]: factor of a robot's acceleration_bounds
  std::span<const double> noise = {};         ///< in [0, 1]: factor of all normally distributed errors of its sensors
};

/// Size and view of an image.
struct ImageOptions {
  int width = 640, height = 480;  ///< [px] in [1, 4096]
  /// [m] x_min, y_min, x_max, y_max that must be visible; nullopt: the whole world
  std::optional<std::array<double, 4>> view;
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< red, green and blue of each pixel, row by row, the top row first
};

/// Call from one thread at a time, even across several simulations of one process, because they share their device.
/// Time 0 is simulated at construction, so readings are available at once.
class SENSORFARM_API Simulation {
 public:
  /// @param world world file, or a ROS map (.yaml). A relative path that does not exist here is looked up among the
  /// installed worlds.
  /// @throws Error, DeviceError
  explicit Simulation(const std::string& world, const Options& options = {});
  /// Creates a simulation of a world given as text. @param name for messages; files that the text includes are looked
  /// up in the folder of this name
  static Simulation from_text(const std::string& text, const Options& options = {},
                              const std::string& name = "given.world");
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Advances by one tick: robots execute their commands, then due sensors are read. Without an argument the previous
  /// commands apply.
  /// @param commands one per row; ignored for rows with a controller and for rows of other ranks
  /// @throws Error for a wrong number of commands, numbers that are not finite, and a controller that fails
  void step();
  void step(std::span<const Twist> commands);
  /// Restarts at time 0, optionally with another seed for poses of clones, noise and controllers. Of several worlds,
  /// world k gets that seed + k.
  void reset();
  void reset(std::uint64_t seed);
  /// Restarts some of several worlds, at time 0 of their own clocks; the others are unchanged, and no time passes
  /// for them. Readings of the new start are available at once.
  /// @param worlds numbers below `copies`, each once  @param seeds one per world, as Options::seed of that world alone
  /// @param starts what seeds do not choose; without it, the worlds are those of simulations of each alone
  /// @throws Error, with nothing changed, for other arguments, and if a world has a sensor that cannot restart
  void reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
             const WorldStarts& starts = {});
  /// Returns observations that this simulation writes from now on, as long as the handle exists; a `reset` of the whole
  /// simulation keeps them. @throws Error for options out of range, an unknown type, and robots that have different
  /// numbers of such sensors or different numbers of elements
  Observations observe(const ObservationOptions& options = {});
  /// Adds a robot, at rest, between two steps. Its sensors are read from the next step on. All other rows, and the
  /// bytes of readings that do not see it, are unchanged. A removed robot returns to its row if its name is added
  /// again. Earlier views of tables are unchanged. Takes time proportional to the fleet (docs/own_controller.md). With
  /// ranks, all of them make this call with the same arguments. A reset removes the robot.
  /// @return its row, the last one for a new name
  /// @throws Error, with nothing changed, for a name that is taken or invalid, an unknown original, a pose that is not
  /// finite, a controller that refuses the robot, more than 65 534 rows, and if several ranks record readings
  std::size_t add_robot(const NewRobot& robot);
  /// Removes a robot or tag between two steps. From the next step on it has a pose of NaN, no body and no readings. Its
  /// row remains, and no other robot gets its row, id or name. @throws Error for a row without a present robot
  void remove_robot(std::size_t row);
  /// Changes the shape, colour or size of a robot or tag between two steps (docs/worlds.md). Sensors, contacts and
  /// images have it from the next step on, which measures all sensors that are due again; readings that do not see it
  /// keep their bytes. Controllers keep the footprint of their start. With ranks, all of them make this call with the
  /// same arguments. A reset restores all shapes.
  /// @throws Error, with nothing changed, for an unknown row, shape or colour, a size out of range or of a row without
  /// an outline, and for more than 1000 changes before a step
  void set_shape(std::size_t row, const ShapeChange& change);
  /// Requests the use of a lane of the road network between two steps. Robots with a route controller replan. A lane is
  /// reversed once it has been empty for 2 s; until then it is closed. With ranks, all of them make this call. A reset
  /// restores all lanes.
  /// @param lane segment and number, such as "3.1" @param use "open", "closed", "reversed", or, for a lane whose end
  /// only turns may leave, "turn", "left" or "right"
  /// @throws Error, with nothing changed, for another lane or use, a use that the lane cannot have, and a world without
  /// roads
  void set_lane(const std::string& lane, const std::string& use);
  /// Places a robot or tag, at rest, between two steps. Its sensors see the new place from the next step on.
  /// It is level there.
  void put(std::size_t row, const Pose& pose);
  /// The same with a tilt, which it keeps while it drives. Lidars and what they see of the body are tilted; contacts
  /// and all other sensors stay planar, at this height.
  /// @param pose the norm of its quaternion is within 0.001 of 1
  void put7(std::size_t row, const Pose7& pose);

  std::size_t copies() const;                 ///< number of worlds
  std::size_t size() const;                   ///< number of rows: robots, and tags if the world contains any
  const std::vector<Robot>& robots() const;   ///< per row of a world
  std::span<const Pose> poses() const;        ///< per row, of the last tick
  std::span<const Pose7> poses7() const;      ///< the same with tilts, computed by this call and valid until the next
  std::span<const Twist> velocities() const;  ///< per row
  /// [m] Per row: radius of the circle about its origin that contains its body, in its present size. Valid until
  /// the next `add_robot`.
  std::span<const double> radii() const;
  std::span<const std::uint8_t> contacts() const;  ///< per row: 1 if a wall or a robot stopped it
  std::span<const std::uint8_t> done() const;      ///< per row: 1 if its controller is done
  std::span<const std::uint8_t> present() const;   ///< per row: 0 if it is not in the world: removed, or
                                                   ///< absent by its model controller

  std::vector<std::string> shapes() const;         ///< names of the world's shapes, in the order of its file
  std::vector<std::string> types() const;          ///< sensor types of this world: "laser", ...
  Readings readings(std::string_view type) const;  ///< @throws Error for a type that the world does not contain
  const std::vector<std::string>& models() const;  ///< names, indexed by `hits`

  double interval() const;                          ///< [s] duration of a tick
  double time(std::size_t world = 0) const;         ///< [s] simulated time of the last tick, of one world
  std::uint64_t tick(std::size_t world = 0) const;  ///< number of the last tick, from 0, of one world
  /// Returns the hash of all readings so far, of one world since its start; equals that of `sensorfarm run`.
  /// @throws Error on ranks other than 0, and for an unknown world
  std::uint64_t hash(std::size_t world = 0) const;
  std::string description() const;                   ///< device and caster, in one line
  const std::vector<std::string>& warnings() const;  ///< about the world file and the device
  unsigned rank() const;                             ///< rank of this process, in [0, ranks())
  unsigned ranks() const;                            ///< number of ranks that share the fleet; 1: only this process
  std::span<const std::uint8_t> owned() const;       ///< per row: 1 if this rank senses and commands it
  /// Ends the recording and writes its index. @throws Error if it cannot be written
  void finish_recording();
  /// Draws walls, robots and tags at their present poses, and fields of view, to a PNG, SVG or PDF file, chosen by its
  /// suffix.
  /// @throws Error if it cannot be written, and without Cairo
  void draw(const std::string& file, std::size_t world = 0) const;
  /// Returns the world from above at this time, north (+y) up, as pixels: ground, walls, traffic lights and the bodies
  /// of robots and tags, without texts and fields of view. The static layer is painted for the first image of a size
  /// and view, and cached for the last four combinations. @throws Error for options out of range, and without Cairo
  Image image(const ImageOptions& options = {}, std::size_t world = 0) const;
  /// Keeps the memory of spans and readings alive beyond the simulation. Its content changes with the next step.
  std::shared_ptr<const void> memory() const;

 private:
  struct State;
  explicit Simulation(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// Ends the processes of all ranks. Without it, they would wait for a process that ends with an error.
[[noreturn]] SENSORFARM_API void abort_ranks(int code);
/// Adds your own controller for the rest of the program, so that `Options::controller` can name it. @throws Error
SENSORFARM_API void add_controller(ControllerEntry entry);
/// Adds your own controller of models for the rest of the program: `ctrl "NAME KEY=VALUE ..."` of models that are not
/// robots can name it in worlds loaded from now on. @throws Error
SENSORFARM_API void add_model_controller(ModelEntry entry);
/// Adds your own sensor type for the rest of the program: worlds loaded from now on may contain such sensors. A
/// kernel's file is relative to the working directory. @throws Error
SENSORFARM_API void add_sensor(SensorEntry entry);
/// The same for a derived sensor type. @throws Error
SENSORFARM_API void add_derived(DerivedEntry entry);
/// Loads a plug-in. Its controllers can be named, and worlds may contain its sensors. @throws Error
SENSORFARM_API void load_plugin(const std::string& file);

}  // namespace sensorfarm
