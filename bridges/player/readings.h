#pragma once
// Data of devices as payloads. No number on the wire is NaN or a negative range, which clients refuse.

#include <cstdint>
#include <vector>

#include "base/report.h"
#include "bridges/player/devices.h"
#include "bridges/player/xdr.h"

namespace sf::bridges::player {

/// A copy of a sensor's last reading.
struct LastReading {
  std::int64_t time = 0;  ///< [ns] of the measurement
  std::uint32_t sequence = 0;
  double height = 0.0;         ///< [m] of the sensor
  std::vector<double> values;  ///< as in base::ReadingBlock; empty: there is none yet
  bool is_new = false;         ///< since the last look
};

/// Subtype of a reading's data. @param stamped with geometry and configuration, where the interface has such a form
std::uint32_t data_subtype(const Device& device, bool stamped);
/// @param report state of the device's mover, for a receiver's speed and course
void put_reading(const Device& device, const LastReading& reading, const base::Report& report, bool stamped,
                 XdrWriter& xdr);

/// position2d's state. @param X_OM the robot's pose by its odometry
void put_state(const base::Pose& X_OM, const base::Report& report, bool stalled, XdrWriter& xdr);

/// player_pose2d: x, y [m], yaw [rad] in [-pi, pi].
void put_pose2d(const base::Pose& pose, XdrWriter& xdr);

}  // namespace sf::bridges::player
