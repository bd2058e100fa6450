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
// No sockets, clocks or windows: the same calls in the same order give the same bytes on one device.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/bytes.h"
#include "base/reading.h"
#include "base/report.h"
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
  std::uint64_t seed = 0;  ///< of all noise
  bool noise = true;       ///< false: no noise, whatever the world file says
  /// Reuses readings for which nothing has changed; false: measures all due sensors. The bytes are the same.
  bool reuse_unchanged = true;
  bool true_poses = true;      ///< reports contain true poses; false: estimated poses
  bool no_return_inf = false;  ///< `hash` takes beams without a return as infinity, as packets have
                               ///< them behind server::NoReturnFilter; readings are unchanged
  unsigned threads = 0;        ///< of the host's part; 0: all of the machine. Does not affect readings
  raycast::SceneOptions scene;
  bool shared = false;  ///< with other processes, each of which senses a part of the fleet: see `Farm::sharing`
};

/// Costs and counts of all ticks so far.
struct FarmStats {
  std::uint64_t ticks = 0;
  std::uint64_t readings = 0;
  std::uint64_t missed = 0;   ///< subscribed readings not measured, as newer ones were due at the same tick
  std::uint64_t reused = 0;   ///< cached readings delivered again
  std::uint64_t batches = 0;  ///< submitted to the device, without those of maps
  sensors::SensorStats work;  ///< of all sensor types
  double place_s = 0.0;       ///< [s] host: outlines of the movers
  double lists_s = 0.0;       ///< [s] host: lists of candidate walls, ray casting on the host, recording of kernels
  double device_s = 0.0;      ///< [s] host: preparation of the submission and the wait for its end
  double collect_s = 0.0;     ///< [s] host sensors, noise, interpolation, maps with their batch, delivery
  double exchange_s = 0.0;    ///< [s] readings of other processes, and the wait for them
  double sensing_s() const { return place_s + lists_s + device_s + collect_s; }
};

inline constexpr std::uint32_t kAllSensorTypes = 0xFFFFFFFFu;

/// Not thread-safe. `world` and `device` must outlive it. Backends are made only for sensor types that the world has.
class Farm {
 public:
  /// @throws base::InputError for a sensor with invalid settings
  /// @throws base::DeviceError when the device is too small
  Farm(const world::World& world, gpu::Device& device, const FarmOptions& options = {});
  ~Farm();

  /// Sets the sensors of a mover that are computed; initially none. Absent movers have none.
  /// @param types bit k: sensor type with wire id k
  void subscribe(std::uint32_t mover, std::uint32_t types);
  void subscribe(std::uint32_t mover, bool) = delete;
  void subscribe_all();

  /// An absent mover is not sensed and loses its subscription. The first report after its return sets its pose.
  void set_absent(std::uint32_t mover, bool gone);

  /// The world has got one more mover, in its last row, which is absent here until its first report. Makes the tables
  /// of all sensors again: takes time in proportion to the fleet. States, schedules, random streams and held readings
  /// of all others go on, so that their readings have the same bytes. Not while readings of others are exchanged.
  /// @return the memory of readings that were returned before, which lasts as long as this
  std::shared_ptr<const void> add_mover();

  /// Sets what the readings of a mover state from now on of the state that they are computed from; initially nothing.
  void set_state_quality(std::uint32_t mover, const base::StateQuality& quality);

  /// @pre FarmOptions::shared
  Sharing& sharing();
  /// The state of the mover's sensors, for a farm that measures them from now on (SensorBackend::write_state).
  void write_sensors(std::uint32_t mover, base::ByteWriter& out) const;
  void read_sensors(std::uint32_t mover, base::ByteReader& in);

  const sensors::SensorSet& sensor_set() const;
  /// For the caller's own loops, between two calls: threads of a second pool would take the cores from these.
  base::ThreadPool& thread_pool();

  /// Computes every subscribed sensor that is due at `now` and returns the readings delivered at `now` (latency may
  /// delay a reading). Movers without a report keep their pose. A sensor is due at phase + k / rate for k = 0, 1, ...;
  /// it is measured at most once a tick, at the first tick not before its due time.
  /// @param now [ns] simulated time; does not decrease
  /// @return blocks that live until the next call of `tick`, `sample`, `sample_between` or `sense`
  std::span<const base::ReadingBlock> tick(std::int64_t now, std::span<const base::Report> reports);

  /// [ns] When the next subscribed sensor is due: phase + k / rate to the nearest nanosecond. farm::kNever without
  /// subscribed sensors.
  std::int64_t next_due() const;
  /// [ns] Delivery time of the next reading held back by latency; farm::kNever: none.
  std::int64_t next_delivery() const;
  /// Like `tick`, at a time between two ticks. Accumulating quantities (wheel rotation) are read at `now` but continue
  /// from the last tick: readings at ticks do not depend on samples in between.
  std::span<const base::ReadingBlock> sample(std::int64_t now, std::span<const base::Report> reports);
  /// `sample` with the states of all movers interpolated between the last tick and the next (robots::interpolate).
  /// @param next one report per mover, at the time of the next tick
  std::span<const base::ReadingBlock> sample_between(std::int64_t now, std::span<const base::Report> next);

  /// Computes one sensor immediately, due or not, as if its mover stood at `X_WM`, with the noise of its
  /// first reading. Sonars start a new firing cycle with it, and maps take its beams: in a farm that ticks, later
  /// readings of both differ.
  /// @param type wire id
  base::ReadingBlock sense(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor, const base::Pose& X_WM);

  /// Hash of the values and hits of all readings delivered so far, call by call: a call without readings counts too.
  /// Of a shared farm: of those chained by `Sharing::add_hashes`.
  std::uint64_t hash() const;
  FarmStats stats() const;

 private:
  struct State;
  std::unique_ptr<State> s_;
};

}  // namespace sf::farm
