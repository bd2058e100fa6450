#pragma once
// A robot's battery: a charge that driving consumes and docks restore (docs/sensors.md).
//
// In a world file, inside a robot:
//   battery( capacity 2.7  charge 1  idle 0.3  driving 3  charging 1.5  voltage [12 16.8]  resistance 0.2
//            dock_reach 0.2 )
// A reading is one row: voltage, current (negative: discharging), charge, and 1 in a dock. An empty battery does not
// stop the robot.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kBattery = 29;  ///< wire id

/// Settings of one battery.
struct Battery {
  double capacity = 2.7;    ///< [A h] > 0
  double charge = 1.0;      ///< [-] in [0, 1], part of the capacity at the start
  double idle = 0.3;        ///< [A] >= 0, at all times
  double driving = 3.0;     ///< [A s/m] >= 0, per metre that the wheels roll (the mean of both, either way)
  double charging = 1.5;    ///< [A] >= 0, from a dock
  double empty = 12.0;      ///< [V] without current at no charge
  double full = 16.8;       ///< [V] without current at full charge; >= empty
  double resistance = 0.2;  ///< [ohm] >= 0
  double dock_reach = 0.2;  ///< [m] from the robot's origin to the dock (is_docked)
};

/// Returns true when a robot is in a dock: its origin is within `reach` [m] of the dock, or it touches the dock's face,
/// up to twice as far away. @param X_WD pose of the dock; it faces along x  @param contact the robot touches something
bool is_docked(const Pose& X_WD, const Pose& X_WM, double reach, bool contact);

/// Returns the usual `reach` of is_docked [m]: the robot's footprint and 3 cm.
double dock_reach_of(const world::Mover& mover);

/// @throws base::InputError with file and line.
Battery read_battery(const world::Sensor& sensor, const world::Mover& mover);

extern const SensorType battery_type;

}  // namespace sf::sensors
