#pragma once
// A simulated fleet, stepped by your program:
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
#include "sensorfarm/sensor.h"

#define SENSORFARM_API __attribute__((visibility("default")))

namespace sensorfarm {

/// A fault that the user can correct: one line, with file and line where there are some.
class SENSORFARM_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// No usable Vulkan device, where one is asked for; one line with every device and the reason for its refusal.
class SENSORFARM_API DeviceError : public Error {
 public:
  using Error::Error;
};

struct Options {
  std::uint32_t robots = 0;  ///< clones of one robot at free poses, in place of the world's robots; 0: the world's own
  std::string of;            ///< robot that is cloned; empty: the first with sensors
  std::uint64_t seed = 1;    ///< of poses, noise and controllers
  unsigned threads = 0;      ///< 0: all cores. Results are the same for any number
  bool noise = true;         ///< false: no noise, whatever the world file says
  std::string accuracy;      ///< accuracy mode of all sensors (docs/accuracy.md); empty: as the world says
  std::string device;  ///< row or part of the name of a Vulkan device, or "host": none, with the same bytes; empty:
                       ///< the best, or the host (as `warnings` states) where no device is usable
  std::string caster = "auto";  ///< "auto" or a name of `sensorfarm run --caster` (docs/accuracy.md#casters), such as
                                ///< "host" or "reference"
  std::string controller;       ///< of all robots, by name or file; empty: commands drive them
  std::vector<std::pair<std::string, std::string>> settings;  ///< of that controller
  std::string record;                                         ///< folder of a recording (run.mcap); empty: none
  bool record_readings = false;  ///< record readings too, not only the states from which they can be computed
  /// Processes that mpirun has started share the fleet (docs/cluster.md): each has the readings of its own robots alone
  /// and commands these; the rest is known to all. All make the same calls with the same arguments, commands apart.
  bool ranks = false;
  bool require_vulkan = false;       ///< without a usable Vulkan device DeviceError, not the host
  bool too_near_min = false;         ///< recorded ranges of surfaces that are too near are range_min, not -infinity
  std::string compression = "zstd";  ///< of the recording: "zstd" or "none", of which a kill loses no tick
  /// "FILE:NAME": the robot NAME of a world file, or that type which it defines, for a world without robots (a ROS
  /// map), or as the robot that is cloned; FILE is found as worlds are. Empty: the default robot, or `of`
  std::string robot_from;
};

/// The newest readings of all sensors of one type, as one table with a row per sensor. A view: valid until the next
/// step, put, add_robot or reset of its simulation; memory that it points to is kept as long as Simulation::memory.
struct Readings {
  std::string_view type;
  std::size_t sensors = 0;              ///< rows: by robot, and in the order of the world file
  std::size_t elements = 0;             ///< of the longest reading: beams of a laser; shorter ones are followed by NaN
  std::size_t columns = 1;              ///< numbers per element
  const double* values = nullptr;       ///< element by element, in each element column by column
  std::size_t stride = 0;               ///< from row to row, in numbers; >= elements * columns
  const std::uint32_t* hits = nullptr;  ///< numbers of the models that beams met, or kNone; null for other types
  std::size_t hit_stride = 0;           ///< from row to row
  std::span<const std::uint32_t> robots;        ///< per row: its robot's row among Simulation::poses
  std::span<const double> times;                ///< [s] per row: of the measurement; NaN before the first
  std::span<const double> bounds;               ///< per row: largest error of the first column, as in Reading::bound
  std::span<const double> bound_without_noise;  ///< per row, as in Reading
  std::span<const double> sigma;                ///< per row, as in Reading
  std::span<const std::uint8_t> fresh;          ///< per row: 1 where it was delivered in the last step
  std::span<const std::uint8_t> flags;          ///< sensors * elements: 0 where a stated bound holds (docs/accuracy.md)

  std::span<const double> row(std::size_t i) const { return {values + i * stride, elements * columns}; }
  std::span<const std::uint32_t> hits_of(std::size_t i) const { return {hits + i * hit_stride, elements}; }
};

/// A robot that joins a simulation.
struct NewRobot {
  std::string name;        ///< 1 to 64 letters, digits or '_', no digit first; of no other model of the world
  std::string like;        ///< robot of the world, or word of its type, that it is a copy of
  Pose pose;               ///< finite; its height is that of the original
  std::string controller;  ///< by name or file; empty: commands drive it
  std::vector<std::pair<std::string, std::string>> settings = {};  ///< of that controller
};

/// Size and view of an image.
struct ImageOptions {
  int width = 640, height = 480;  ///< [px] in [1, 4096]
  /// [m] x_min, y_min, x_max, y_max to show at least; none: the whole world
  std::optional<std::array<double, 4>> view;
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< red, green and blue of each pixel, row by row, the top row first
};

/// One thread at a time, also for several simulations of one process, which share their device. Time 0 is simulated at
/// construction, so there are readings at once.
class SENSORFARM_API Simulation {
 public:
  /// @param world world file, or a ROS map (.yaml). A relative path that does not exist here is looked for among the
  /// installed worlds.
  /// @throws Error, DeviceError
  explicit Simulation(const std::string& world, const Options& options = {});
  /// A world given as text. @param name for messages; files that it includes are looked for in this name's folder
  static Simulation from_text(const std::string& text, const Options& options = {},
                              const std::string& name = "given.world");
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Advances by one tick: robots execute their commands, then sensors that are due are read. Without an argument
  /// commands stay as they are.
  /// @param commands one per row; rows with a controller, and those of other ranks, ignore theirs
  /// @throws Error for another number of commands, numbers that are not finite, and a controller that fails
  void step();
  void step(std::span<const Twist> commands);
  /// Begins anew at time 0, with another seed where one is given: poses of clones, noise, controllers.
  void reset();
  void reset(std::uint64_t seed);
  /// Adds a robot, at rest, between two steps: its sensors are read from the next step on. All other rows, and the
  /// bytes of readings that do not see it, stay as they are. A robot that was removed returns under its name to its
  /// row. Views of tables before stay as they were. Takes time in proportion to the fleet (docs/own_controller.md).
  /// With ranks, all call this alike. A reset forgets it.
  /// @return its row, the last one for a new name
  /// @throws Error, with nothing changed, for a name that is taken or none, an unknown original, a pose that is not
  /// finite, a controller that refuses, beyond 65 534 rows, and where several ranks record readings
  std::size_t add_robot(const NewRobot& robot);
  /// Removes a robot or tag between two steps: from the next one on it has a pose of NaN, no body and no readings. Its
  /// row stays, and no other robot gets its row, id or name. @throws Error for a row without a present robot
  void remove_robot(std::size_t row);
  /// Places a robot or tag, at rest, between two steps. Its sensors see it from the next step on.
  void put(std::size_t row, const Pose& pose);

  std::size_t size() const;                        ///< rows: robots, and tags if the world has some
  const std::vector<Robot>& robots() const;        ///< per row
  std::span<const Pose> poses() const;             ///< per row, of the last tick
  std::span<const Twist> velocities() const;       ///< per row
  std::span<const std::uint8_t> contacts() const;  ///< per row: 1 where a wall or a robot stopped it
  std::span<const std::uint8_t> done() const;      ///< per row: 1 where its controller is done
  std::span<const std::uint8_t> present() const;   ///< per row: 0 where it was removed

  std::vector<std::string> types() const;          ///< sensor types of this world: "laser", ...
  Readings readings(std::string_view type) const;  ///< @throws Error for a type that the world does not have
  const std::vector<std::string>& models() const;  ///< names, by the numbers in `hits`

  double interval() const;          ///< [s] of a tick
  double time() const;              ///< [s] of the last tick
  std::uint64_t tick() const;       ///< its number, from 0
  std::uint64_t hash() const;       ///< of all readings so far; that of `sensorfarm run`. @throws Error on ranks but 0
  std::string description() const;  ///< device and caster, in one line
  const std::vector<std::string>& warnings() const;  ///< of the world file, and of the device
  unsigned rank() const;                             ///< of this process, below `ranks`
  unsigned ranks() const;                            ///< that share the fleet; 1: none but this
  std::span<const std::uint8_t> owned() const;       ///< per row: 1 where this rank senses and commands
  /// Ends the recording, with its index. @throws Error when it cannot be written
  void finish_recording();
  /// Draws walls, robots and tags at their present poses, and fields of view, to a PNG, SVG or PDF file by its suffix.
  /// @throws Error when it cannot be written, and without Cairo
  void draw(const std::string& file) const;
  /// The world from above at this time, north (+y) up, as pixels: ground, walls, traffic lights and the bodies of
  /// robots and tags, without texts and fields of view. The static layer is painted for the first image of a size and
  /// view, and kept for the last four. @throws Error for options out of range, and without Cairo
  Image image(const ImageOptions& options = {}) const;
  /// Keeps the memory behind spans and readings, whose content changes with the next step, beyond the simulation.
  std::shared_ptr<const void> memory() const;

 private:
  struct State;
  explicit Simulation(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

/// Ends the processes of all ranks, which would wait for one that ends by an error alone.
[[noreturn]] SENSORFARM_API void abort_ranks(int code);
/// Adds a controller of your own for the rest of the program: `Options::controller` can name it. @throws Error
SENSORFARM_API void add_controller(ControllerEntry entry);
/// Adds a sensor type of your own for the rest of the program: worlds loaded from now on may have such sensors. A
/// kernel's file is relative to the working directory. @throws Error
SENSORFARM_API void add_sensor(SensorEntry entry);
/// Loads a plug-in: its controllers can be named, its sensors stand in worlds. @throws Error
SENSORFARM_API void load_plugin(const std::string& file);

}  // namespace sensorfarm
