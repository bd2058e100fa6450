#pragma once
// The tick: reports in, one batch on the device, readings out.
//
//   farm.hear_all();
//   while (running) {
//     readings = farm.tick(now, reports);   // in, up, run, down, out
//     for (reading : readings) send(reading);
//   }
//
// Sensors that are due between two ticks look at their own times where `sample` is called for each of these:
//
//   while ((due = farm.next_due()) < now) farm.sample(due, reports at that time);
//
// No sockets, no clock, no window: the same calls in the same order give the same bytes, on one device.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/reading.h"
#include "base/report.h"
#include "farm/schedule.h"
#include "gpu/device.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::farm {

struct FarmOptions {
  std::uint64_t seed = 0;  ///< of all noise
  bool noise = true;       ///< false: none, whatever the world says
  bool reuse_unchanged =
      true;  ///< a reading for which nothing has changed; false: everyone who is due looks. The same bytes
  bool true_poses = true;      ///< reports say where movers are; false: where they believe to be
  bool no_return_inf = false;  ///< readings are sent with infinity where a beam met nothing: so `hash` takes them
  unsigned threads = 0;        ///< for the host's part; 0: as many as the machine has. Never changes a reading
  raycast::SceneOptions scene;
};

/// What the ticks so far cost and did.
struct FarmStats {
  std::uint64_t ticks = 0;
  std::uint64_t readings = 0;
  std::uint64_t missed = 0;   ///< readings of heard sensors never taken: newer ones were due at the same tick
  std::uint64_t reused = 0;   ///< readings given again: nothing they depend on had moved
  std::uint64_t batches = 0;  ///< submitted to the device
  sensors::SensorStats work;  ///< of all kinds together
  double place_s = 0.0;       ///< [s] host: movers' outlines
  double lists_s = 0.0;       ///< [s] host: what each sensor may meet
  double device_s = 0.0;      ///< [s] submit to done
  double collect_s = 0.0;     ///< [s] host: noise, interpolation, delivery
};

inline constexpr std::uint32_t kAllSensorTypes = 0xFFFFFFFFu;

/// Not thread-safe. `world` and `device` must outlive it. Only kinds of sensors that the world has are built.
class Farm {
 public:
  /// @throws base::InputError for a sensor whose settings make no sense, base::DeviceError when the device is too
  /// small.
  Farm(const world::World& world, gpu::Device& device, const FarmOptions& options = {});
  ~Farm();

  /// Which of a mover's sensors are computed: none at first.
  /// @param kinds bit k: those of the kind with wire id k.
  void subscribe(std::uint32_t mover, std::uint32_t kinds);
  void subscribe(std::uint32_t mover, bool) = delete;
  void subscribe_all();

  /// A mover that is gone is sensed by nobody, and not heard. When it is back, the first report says where it is.
  void set_absent(std::uint32_t mover, bool gone);

  const sensors::SensorSet& sensor_set() const;

  /// Computes every heard sensor that is due at `now` and returns what is delivered at `now` (latency may delay a
  /// reading). Movers without a report stay where they were. A sensor is due at phase + k / rate for k = 0, 1, ...: at
  /// most once a tick, at the first tick not before that time.
  /// @param now [ns] simulated time; does not go back.
  /// @return blocks that live until the next tick.
  std::span<const base::ReadingBlock> tick(std::int64_t now, std::span<const base::Report> reports);

  /// When the next heard sensor is due, phase + k / rate to the nearest nanosecond. [ns] farm::kNever: none is heard
  std::int64_t next_due() const;
  /// When the next reading that latency holds back is to be delivered. [ns] farm::kNever: none is
  std::int64_t next_delivery() const;
  /// As `tick`, at a time between two ticks. What adds up over time (wheels) is read as it is then and goes on from the
  /// last tick: readings at ticks do not depend on who looked in between.
  std::span<const base::ReadingBlock> sample(std::int64_t now, std::span<const base::Report> reports);

  /// Computes one sensor at once, due or not, as if its mover stood at `X_WM`; noise off unless the options say so.
  /// @param kind wire id.
  base::ReadingBlock sense(std::uint32_t mover, std::uint8_t kind, std::uint32_t sensor, const base::Pose& X_WM);

  /// Hash of all readings delivered so far, in order.
  std::uint64_t hash() const;
  FarmStats stats() const;

 private:
  struct State;
  std::unique_ptr<State> s_;
};

}  // namespace sf::farm
