#pragma once
// The encoders, gyro and satellite receiver by which a simulated robot localizes itself. The robot measures them in its
// own process, by its true state: the farm's readings of these types are computed from the states that the robot
// sends, which are estimates.

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "base/report.h"
#include "control/own_localization.h"
#include "sensors/gnss_visibility.h"
#include "sensors/sensor_set.h"
#include "server/own_state.h"

namespace sf::server {

/// Times [ns] are on the robot's own monotonic clock. The world must outlive it. Not thread-safe.
class SimulatedSensors {
 public:
  /// @param sensors of the mover, as in its definition
  SimulatedSensors(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
                   const control::PositionSensors& sensors, std::uint64_t seed);

  /// Adds the readings of a motion that ends `now` to `own`. The gyro measures at most once per motion.
  void measure(const base::Pose& before, const base::Report& after, std::int64_t now, OwnState& own);

 private:
  /// When readings of one sensor are due, and where it is mounted.
  struct Schedule {
    Schedule(const sensors::SensorSet& sensor_set, std::uint8_t type, std::uint32_t mover);
    bool is_due(std::int64_t now);

    std::int64_t period, latency;  ///< [ns]
    base::Pose X_MS;
    std::int64_t next = 0;       ///< [ns]
    std::uint64_t sequence = 0;  ///< of the last reading, from 1
  };
  struct Gyro {
    Schedule schedule;
    sensors::GyroModel model;
  };
  struct Gps {
    Schedule schedule;
    sensors::GpsModel model;
    sensors::GnssVisibility visibility;
    base::RandomKey draw;
  };
  struct Fix {
    std::int64_t time = 0;  ///< [ns]
    std::array<double, 6> values{};
  };
  void measure_gps(const base::Pose& X_WM, std::int64_t now, OwnState& own);

  std::optional<sensors::Wheels> wheels_;
  std::int64_t measured_ = -1;  ///< [ns] end of the last motion; -1: none
  std::optional<Gyro> gyro_;
  std::optional<Gps> gps_;
  std::deque<Fix> fixes_;  ///< measured, but not delivered yet
};

}  // namespace sf::server
