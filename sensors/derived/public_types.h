#pragma once
// The farm's types as those of the public interface (sensorfarm/).

#include "sensorfarm/controller.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline sensorfarm::Pose public_pose(const base::Pose& X) { return {X.x, X.y, X.z, X.yaw}; }
inline sensorfarm::Twist public_twist(const base::Twist& twist) { return {twist.forward, twist.left, twist.turn}; }
sensorfarm::SensorInfo public_info(const SensorType& type, const SensorSpec& spec);
/// Returns a view of a reading, valid as long as its block's spans.
sensorfarm::Reading public_reading(const base::ReadingBlock& reading, const SensorType& type);

}  // namespace sf::sensors
