#pragma once
// The sensor farm: reports in, a batch on the device, readings out.
//
//   farm.subscribe_all();
//   while (running) {
//     readings = farm.tick(now, reports);  // reports: newest states of movers
//     for (reading : readings) send(reading);
//   }
//
// Sensors that are due between two ticks are measured at their own times, before the later tick and with its reports:
//
//   while ((due = farm.next_due()) < now) farm.sample_between(due, reports);
//
// Uses no sockets, clocks or windows: the same calls in the same order give the same bytes on one device.

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "base/report.h"
#include "farm/dropped_reading.h"
#include "farm/fault.h"
#include "farm/schedule.h"
#include "farm/sharing.h"
#include "gpu/device.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::base {
class ThreadPool;
}

namespace sf::farm {

struct FarmOptions {
  std::uint64_t seed = 0;  ///< seed of all noise
  bool noise = true;       ///< false: no noise, whatever the world file says
  /// Reuses readings for which nothing has changed; false: measures all due sensors. The bytes are the same.
  bool reuse_unchanged = true;
  bool true_poses = true;      ///< reports contain true poses; false: estimated poses
  bool no_return_inf = false;  ///< `hash` treats beams without a return as infinite, like packets ⏎ after
                               ///< server::NoReturnFilter; readings are unchanged
  unsigned threads = 0;        ///< number of host threads; 0: all cores. Does not affect readings
  raycast::SceneOptions scene;
  bool shared = false;  ///< shares the fleet with other processes, each of which senses a part of it; see
                        ///< `Farm::sharing`
  /// [s] processor time of readings per `budget_tick`, as `processor_clock` [s] measures it (empty: that of this
  /// process). 0: no limit. Beyond it, readings are dropped by priority (farm/processor_budget.h), so that results
  /// depend on the clock. Not with `shared`.
  double processor_budget = 0.0;
  double budget_tick = 0.0;  ///< [s] 0: the world's interval
  std::function<double()> processor_clock;
  std::vector<Fault> faults;  ///< of its sensors, in the order in which they act; not of `Farm::sense`
};

/// Costs and counts of all ticks so far.
struct FarmStats {
  std::uint64_t ticks = 0;
  std::uint64_t readings = 0;
  std::uint64_t missed = 0;    ///< subscribed readings that were not measured, because newer ones were due at the same
                               ///< tick
  std::uint64_t dropped = 0;   ///< not measured because the budget was exhausted
  std::uint64_t reused = 0;    ///< cached readings that were delivered again
  std::uint64_t batches = 0;   ///< submitted to the device, excluding those of maps
  base::FaultCounts faults{};  ///< readings affected by faults
  sensors::SensorStats work;   ///< work of all sensor types
  double place_s = 0.0;        ///< [s] host: outlines of the movers
  double lists_s = 0.0;        ///< [s] host: lists of candidate walls, ray casting on the host, recording of kernels
  double device_s = 0.0;       ///< [s] host: preparation of the submission, and the wait for its completion
  double collect_s = 0.0;      ///< [s] host sensors, noise, interpolation, maps with their batch, delivery
  double exchange_s = 0.0;     ///< [s] readings of other processes, and the wait for them
  double sensing_s() const { return place_s + lists_s + device_s + collect_s; }
};

inline constexpr base::SensorTypes kAllSensorTypes = ~base::SensorTypes{0};

/// Not thread-safe. `world` and `device` must outlive it. Creates backends only for sensor types that the world
/// contains.
class Farm {
 public:
  /// @throws base::InputError for a sensor with invalid settings, and for invalid faults (check_faults), except that
  /// faults of unknown robots or sensors have no effect
  /// @throws base::DeviceError if the device is too small
  Farm(const world::World& world, gpu::Device& device, const FarmOptions& options = {});
  ~Farm();

  /// Sets the sensors of a mover that are computed; initially none. Absent movers have none.
  void subscribe(std::uint32_t mover, base::SensorTypes types);
  void subscribe(std::uint32_t mover, std::same_as<bool> auto) = delete;
  void subscribe_all();

  /// Sets whether a mover is absent. An absent mover is not sensed and loses its subscription. The first report after
  /// its return sets its pose.
  void set_absent(std::uint32_t mover, bool gone);

  /// Call this after the world has gained one mover, in its last row. The mover is absent here until its first report.
  /// Rebuilds the tables of all sensors, which takes time proportional to the fleet. States, schedules, random streams
  /// and delayed readings of all other movers continue, so that their readings have the same bytes. Not allowed while
  /// readings are exchanged with other processes.
  /// @return the memory of readings that were returned before; they are valid as long as it is held
  std::shared_ptr<const void> add_mover();

  /// Call this after outlines of movers have changed in the world (world::change_shape), once for many changes, and
  /// before any tick. Casters keep their lists of walls; sensors whose tables cannot be updated
  /// (SensorBackend::update_outlines) are rebuilt. The guarantees are those of `add_mover`; `sensor_set` remains.
  /// @return the memory of readings of rebuilt sensors that were returned before; valid as long as it is held
  std::shared_ptr<const void> update_outlines();

  /// Sets the state quality stamped on this mover's readings from now on; initially none.
  void set_state_quality(std::uint32_t mover, const base::StateQuality& quality);

  /// Sets a function that may replace the values of readings, by memory that is valid until its next call. It gets the
  /// readings of each tick and sample after noise and faults, and before maps, latency and derived sensors; not those
  /// of `sense`.
  using Fuse = std::function<void(std::span<base::ReadingBlock>)>;
  void fuse_with(Fuse fuse);

  /// @pre FarmOptions::shared
  Sharing& sharing();
  /// Writes the state of the mover's sensors, for a farm that measures them from now on (SensorBackend::write_state).
  void write_sensors(std::uint32_t mover, base::ByteWriter& out) const;
  void read_sensors(std::uint32_t mover, base::ByteReader& in);

  const sensors::SensorSet& sensor_set() const;
  const raycast::Episodes& episodes() const;
  /// Returns the thread pool for the caller's own loops between two calls: threads of a second pool would compete with
  /// it for the cores.
  base::ThreadPool& thread_pool();

  /// Computes every subscribed sensor that is due at `now`, and returns the readings delivered at `now` (latency may
  /// delay a reading). Movers without a report keep their pose. A sensor is due at phase + k / rate for k = 0, 1, ...;
  /// it is measured at most once per tick, at the first tick not before its due time.
  /// @param now [ns] simulated time; does not decrease
  /// @return blocks that are valid until the next call of `tick`, `sample`, `sample_between` or `sense`
  std::span<const base::ReadingBlock> tick(std::int64_t now, std::span<const base::Report> reports);

  /// Restarts copies of the world at the time of the last tick: their clocks are 0, their sensors and random numbers
  /// are those of a world alone with the seed. Returns their readings of this first tick; those of the other
  /// copies are unchanged. Not after a sample, and not with faults, a budget or a shared fleet.
  /// @param reports of all movers of these copies, at that time
  /// @throws base::InputError if a sensor of such a copy cannot restart
  struct Restart {
    std::uint32_t copy = 0;
    std::uint64_t seed = 0;
  };
  std::span<const base::ReadingBlock> restart(std::span<const Restart> restarts, std::span<const base::Report> reports);

  /// Sets the twists that movers executed until the next tick, per mover: inputs of derived sensors. They are read
  /// during that tick.
  void set_commands(std::span<const base::Twist> commands);
  /// Sets readings of pseudo-types that movers received by the next tick, such as poses of cameras
  /// (sensors::kCameraInput): inputs of derived sensors. They are read during that tick.
  void set_received(std::span<const base::ReadingBlock> readings);
  /// Returns the inputs of that pseudo-type, in order, each once.
  struct ReceivedInput {
    std::uint32_t mover = 0;     ///< of which it is an input
    std::uint32_t receiver = 0;  ///< that carries the derived sensor
    auto operator<=>(const ReceivedInput&) const = default;
  };
  std::vector<ReceivedInput> received_inputs(std::uint8_t type) const;

  /// Returns the readings that the last tick or sample dropped because the budget was exhausted. Valid until the next.
  std::span<const DroppedReading> dropped() const;

  /// Returns when the next subscribed sensor is due [ns]: phase + k / rate to the nearest nanosecond. farm::kNever
  /// without subscribed sensors.
  std::int64_t next_due() const;
  /// Returns the delivery time [ns] of the next reading delayed by latency; farm::kNever: none.
  std::int64_t next_delivery() const;
  /// [ns] Returns when a delivered reading was due for delivery, possibly between two ticks.
  std::int64_t delivery_time(const base::ReadingBlock& reading) const;
  /// Returns the readings measured by the last `tick`, `sample` or `sample_between` that faults affected, including
  /// lost ones; valid until the next call.
  std::span<const base::FaultMark> fault_marks() const;
  /// Does the same as `tick`, at a time between two ticks. Accumulating quantities (wheel rotation) are read at `now`
  /// but continue from the last tick, so readings at ticks do not depend on samples in between.
  std::span<const base::ReadingBlock> sample(std::int64_t now, std::span<const base::Report> reports);
  /// Calls `sample` with the states of all movers interpolated between the last tick and the next
  /// (robots::interpolate).
  /// @param next one report per mover, at the time of the next tick
  std::span<const base::ReadingBlock> sample_between(std::int64_t now, std::span<const base::Report> next);

  /// Computes one sensor immediately, due or not, as if its mover were at `X_WM` with `tilt`, with the noise of its
  /// first reading. Sonars start a new firing cycle with it, and maps include its beams: in a farm that ticks, later
  /// readings of both differ.
  /// @param type wire id
  base::ReadingBlock sense(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor, const base::Pose& X_WM,
                           const base::Tilt& tilt = {});

  /// Returns the hash of the values and hits of all readings delivered so far, call by call: a call without readings
  /// counts too. For a shared farm, the hash of the readings chained by `Sharing::add_hashes`.
  /// @param copy of the world: the hash of its readings alone, since its last restart
  std::uint64_t hash(std::uint32_t copy = 0) const;
  FarmStats stats() const;
  /// Returns a line for each derived sensor that was evaluated and never valid (DerivedSensors::never_valid).
  std::vector<std::string> never_valid() const;

 private:
  struct State;
  std::unique_ptr<State> s_;
};

}  // namespace sf::farm
