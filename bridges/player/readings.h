#pragma once
// Data of devices as payloads. Values on the wire are never NaN or negative ranges, which clients reject, except in
// opaque data.

#include <cstdint>
#include <vector>

#include "base/report.h"
#include "bridges/player/devices.h"
#include "netio/player/xdr.h"

namespace sf::bridges::player {

/// A copy of a sensor's last reading.
struct LastReading {
  std::int64_t time = 0;  ///< [ns] of the measurement
  std::uint32_t sequence = 0;
  double height = 0.0;         ///< [m] of the sensor
  std::vector<double> values;  ///< as in base::ReadingBlock; empty: no reading yet
  bool is_new = false;         ///< since the last `look`
};

/// Returns the subtype of a reading's data.
/// @param stamped with geometry and configuration, if the interface supports it
std::uint32_t data_subtype(const Device& device, bool stamped);
/// Opaque data is u32 wire id of the sensor type, sequence, rows, columns, and f64 values row by row, little-endian.
/// @param report state of the device's mover, for the speed and course of a receiver
void put_reading(const Device& device, const LastReading& reading, const base::Report& report, bool stamped,
                 XdrWriter& xdr);

/// Appends the state of position2d.
/// @param X_OM the robot's pose by its odometry
void put_state(const base::Pose& X_OM, const base::Report& report, bool stalled, XdrWriter& xdr);

/// player_pose2d: x, y [m], yaw [rad] in [-pi, pi].
void put_pose2d(const base::Pose& pose, XdrWriter& xdr);

}  // namespace sf::bridges::player
