#pragma once
// Monitor: a robot's pose from its own sensors, of which one may be faulty, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "monitor"  inputs ["encoder" "gyro" "gps"]  rate 20  hold 10 )
// Inputs: at least two of one encoder, one gyro and one gps, among them an encoder or a gps. `thresholds`: those of
// estimation::MonitorThresholds in its order (fast, slow, roughness: nine numbers). `hold`: [s] time without a large
// residual before a faulty input is used again.
//
// A reading is one row: pose, `valid` and covariance, as in a localization; forward speed and yaw rate, which replace
// those of a faulty encoder or gyro; the states of encoder, gyro and gps (0 good, 1 faulty, 2 absent, 3 suspected); and
// their residuals as shares of the thresholds. States and residuals are also stated where the pose is not
// valid; speeds are NaN there.

#include "robots/estimation/localization_monitor.h"
#include "sensors/localization.h"

namespace sf::sensors {

inline constexpr std::uint8_t kMonitor = 35;  ///< wire id

/// Columns of a reading.
inline constexpr std::size_t kMonitorSpeedAt = 10, kMonitorStatesAt = 12, kMonitorResidualsAt = 15;

/// Returns the monitor of a robot's own sensors. @param monitor with any periods and latencies; these are the sensors'
estimation::LocalizationMonitor monitor_of(const world::Mover& mover, const PositionSensors& sensors,
                                           estimation::MonitorOptions monitor);

extern const SensorType monitor_type;

}  // namespace sf::sensors
