#pragma once
// The derived sensors of a farm: when they are due, which inputs they need, and the delivery of their readings.

#include <cstdint>
#include <span>
#include <vector>

#include "farm/delivery.h"
#include "farm/sensor_pipeline.h"
#include "sensors/derived/derived_sensors.h"

namespace sf::farm {

/// Costs nothing in worlds without derived sensors. Not thread-safe.
class Derivation {
 public:
  /// Arguments must outlive it, except that `context` is copied.
  Derivation(const sensors::SensorContext& context, const sensors::SensorSet& sensor_set);

  bool empty() const { return pipelines_.empty(); }
  const sensors::DerivedSensors& sensors() const { return sensors_; }
  std::span<SensorPipeline> pipelines() { return pipelines_; }
  /// Continues the sensors of the farm before a new mover. `before` must not be used afterwards.
  void go_on(Derivation& before, std::int64_t last_tick, std::int64_t last_call);

  /// Resets the sensors of movers [first, end) at the start of their episode.
  void restart(std::uint32_t first, std::uint32_t end);
  /// @throws base::InputError if a sensor has inputs of other robots, whose readings other processes may have
  void require_own_inputs(const world::World& world) const;
  /// Call this when subscriptions have changed. @param measured pipelines of the other types: gain the sensors that are
  /// needed as inputs. Empty: all inputs are subscribed  @param gone as for DerivedSensors::want
  void update_demand(std::span<const base::SensorTypes> subscribed, std::span<SensorPipeline> measured,
                     std::span<const std::uint8_t> gone = {});
  /// Makes one sensor due together with the sensors below it, instead of those whose time it is.
  void request(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor, std::span<SensorPipeline> measured);
  /// See SensorPipeline.
  std::uint64_t find_due(std::int64_t now, std::span<const base::SensorTypes> subscribed);
  std::int64_t next_due(std::span<const base::SensorTypes> subscribed) const;

  /// Returns `delivered` and the due readings of derived sensors, without latency; valid until the next call.
  /// @param stage see sensors::DerivedSensors
  std::span<const base::ReadingBlock> evaluate(std::int64_t now, std::span<const base::ReadingBlock> delivered,
                                               std::span<const base::Report> states,
                                               const sensors::DerivedSensors::Stage& stage = {});
  /// Sets the inputs `command` of the next evaluation: per mover.
  void set_commands(std::span<const base::Twist> commands) { commands_ = commands; }
  /// Sets the other inputs of the next evaluation that robots receive (sensors::is_received).
  void set_received(std::span<const base::ReadingBlock> received) { received_ = received; }
  /// @param delivered readings delivered at `now`, including late ones of derived sensors
  /// @param faults apply to readings of derived sensors
  /// @param delivery holds readings of derived sensors with latency until they are delivered
  /// @param subscribed per mover: the others' readings serve as inputs only, and are left out of the result
  /// @return the delivered readings, then those of derived sensors; valid until the next call
  std::span<const base::ReadingBlock> derive(std::int64_t now, std::span<const base::ReadingBlock> delivered,
                                             std::span<const base::Report> states, Faults& faults, Delivery& delivery,
                                             std::span<const base::SensorTypes> subscribed);

 private:
  const sensors::SensorSet& sensor_set_;
  sensors::DerivedSensors sensors_;
  std::vector<SensorPipeline> pipelines_;  ///< of the derived types, for their due times
  std::vector<std::span<const sensors::DueSample>> due_;
  std::vector<base::ReadingBlock> delivered_;
  std::span<const base::Twist> commands_;
  std::span<const base::ReadingBlock> received_;
};

}  // namespace sf::farm
