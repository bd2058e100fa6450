#pragma once
// Many worlds that stay on a Vulkan device: a tick is one submission, and nothing is copied back until it is asked for.
//
//   sensorfarm::DeviceWorlds worlds("rooms.world", {.robots = 1, .copies = 1000});
//   worlds.step(commands);                          // one per row
//   const sensorfarm::Readings scans = worlds.readings();  // copies the ranges of all worlds to the host
//
// For robots that commands drive and that have lasers. Everything else is refused, and simulated by Simulation with
// copies, to the same bytes.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sensorfarm/simulation.h"

namespace sensorfarm {

/// A table on the device: values of agents, or the commands (forward, left [m/s], turn [rad/s]) of all rows.
enum class DeviceTable { observations, commands, distances, progress };

/// Memory of worlds on a device: number k of row i is at i * stride + k.
struct DeviceArray {
  void* data = nullptr;  ///< 64-bit floats
  bool single = false;   ///< 32-bit floats instead
  std::size_t rows = 0, columns = 0, stride = 0;
  int cuda = -1;        ///< from 0 on: `data` is an address of CUDA, on its device of this number
  bool copied = false;  ///< the memory is the host's: a step or `update` copies between it and the device's
  std::shared_ptr<const void> memory = nullptr;  ///< keeps the memory, and the worlds with it
};

/// World k has seed + k, and the bytes of a Simulation of that world alone with this seed. Time 0 is simulated at
/// construction. Call from one thread at a time, as Simulation. All arrays are as those of a Simulation, and valid
/// until the next step or reset; the first call after one of these copies them from the device.
class SENSORFARM_API DeviceWorlds {
 public:
  /// @param world as for Simulation  @param options `robots`, `of`, `robot_from`, `seed`, `copies`, `noise`, `accuracy`
  /// and `device`; "none" for `controller`
  /// @throws Error for what a device cannot simulate; DeviceError without a Vulkan device, or if a table exceeds it
  explicit DeviceWorlds(const std::string& world, const Options& options = {});
  static DeviceWorlds from_text(const std::string& text, const Options& options = {},
                                const std::string& name = "given.world");
  DeviceWorlds(DeviceWorlds&&) noexcept;
  DeviceWorlds& operator=(DeviceWorlds&&) noexcept;
  ~DeviceWorlds();

  /// Advances all worlds by one tick, then reads the lasers. @param commands one per row; none: the previous ones
  /// @throws Error for a wrong number of commands and numbers that are not finite
  void step(std::span<const Twist> commands = {});
  /// Restarts some worlds at time 0, as Simulation::reset. Reading them before the next step reads all lasers again.
  /// @param worlds numbers below `copies`, each once  @param seeds one per world  @param starts as there, without
  /// sizes, slip and acceleration; |yaw| up to 1e4 rad
  /// @throws Error, with nothing changed, for other arguments
  void reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds,
             const WorldStarts& starts = {});

  std::size_t copies() const;                ///< number of worlds
  std::size_t size() const;                  ///< number of rows, of all worlds
  const std::vector<Robot>& robots() const;  ///< per row of a world
  double interval() const;                   ///< [s] duration of a tick

  std::span<const Pose> poses() const;             ///< per row; NaN if it is not in the world
  std::span<const Twist> velocities() const;       ///< per row
  std::span<const std::uint8_t> contacts() const;  ///< per row: 1 if a wall or a robot stopped it
  /// The lasers' ranges: `type` to `robots` of the table; the rest is empty.
  /// @throws DeviceError, as the three above, if the device ends long loops early (lavapipe before Mesa 25.0)
  Readings readings() const;

  /// From now on each submission also computes what learners observe, as Simulation::observe, and what rewards need. A
  /// later call replaces it. @throws Error as Simulation::observe
  void observe(const ObservationOptions& options = {});
  /// Sets x and y [m] of the goal of each agent, as Observations::goals and `update`. NaN: none.
  /// @pre `observe`  @throws Error for a wrong number of goals and numbers that are infinite
  void set_goals(std::span<const double> goals);
  std::size_t agents() const;                   ///< robots with a laser, by row; 0 before `observe`
  std::size_t columns() const;                  ///< of a row of observations
  std::span<const float> observations() const;  ///< agents() * columns(), agent by agent
  std::span<const double> distances() const;    ///< [m] per agent, as Observations::distances
  std::span<const double> progress() const;     ///< [m] per agent, as Observations::progress

  /// Returns memory that steps use, without a copy where host and device share it, e.g. on lavapipe. Commands may be
  /// written between calls; step() executes them, and numbers that are not finite count as 0. The others are results,
  /// up to date after `update`, until the next step, reset or set_goals; `observe` leaves them behind. With libcuda and
  /// a GPU that exports its memory, it is that memory: synchronize CUDA before each call that follows writes. This has
  /// not run on hardware. Elsewhere it is the host's copy.
  /// @throws Error before `observe`, except for commands
  DeviceArray array(DeviceTable table);
  /// Brings all arrays up to date. @throws DeviceError as `readings`
  void update();

 private:
  struct State;
  explicit DeviceWorlds(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

}  // namespace sensorfarm
