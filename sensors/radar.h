#pragma once
// Radars: range, bearing and closing speed of movers, as object lists of automotive radars (docs/sensors.md#radar).
//
// In a world file, inside a robot:
//   radar( targets 32  range [0.2 100]  fov 90  columns 181  noise [0.1 0.3 0.03]  detection_range 80 )
// A fan of beams samples the scene of spatial scans: walls, movers, meshes, terrain. A target is a mover that a beam
// meets before anything else; its point is the nearest hit of these beams. A reading has `targets` rows, the nearest
// target first; the rest are NaN.

#include <array>
#include <cstdint>
#include <memory>

#include "sensors/lidar_beams.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kRadar = 50;         ///< wire id
inline constexpr std::uint32_t kRadarNumbers = 4;  ///< numbers of a row: range, bearing, closing speed, elevation
inline constexpr std::uint32_t kMostTargets = 78;  ///< rows of a reading: one datagram
inline constexpr std::uint32_t kMostRadarBeams = 65'536;  ///< of one radar

/// Settings of one radar. Arrays are in the order of the columns.
struct RadarSettings {
  base::RigidTransform X_MS;                  ///< sensor in the mover's frame
  double range_min = 0.0, range_max = 100.0;  ///< [m] in [0, range_max], > 0
  bool with_static = false;                   ///< models that are no movers are targets, too
  std::array<double, kRadarNumbers> noise{};  ///< [m], [rad], [m/s], [rad] standard deviations
  std::array<double, kRadarNumbers> step{};   ///< the same units: readings are whole multiples; 0: not rounded
  std::array<double, kRadarNumbers> cell{};   ///< targets closer than this in the first three merge; 0: none do
  double detection_range = 0.0;               ///< [m] where half of the targets are detected; 0: all are, anywhere
  std::shared_ptr<const LidarBeams> beams;
};

/// Returns the probability that a target is detected, in [0, 1]: Swerling's first case, a cross section that fluctuates
/// from reading to reading, with 1e-6 false alarms and a signal that falls with the fourth power of the range
/// (Richards, "Fundamentals of Radar Signal Processing", 2005, 6.3).
/// @param range [m] >= 0  @param half [m] > 0: the range at which the probability is 1/2
double detection_probability(double range, double half);

/// Reads the settings, without the beams. @throws base::InputError for invalid ones
RadarSettings read_radar(const world::Sensor& sensor);

extern const SensorType radar_type;

}  // namespace sf::sensors
