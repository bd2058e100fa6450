#pragma once
// The laser's accuracy modes and their error bounds.

#include <vector>

#include "sensors/laser_settings.h"
#include "sensors/sensor_set.h"

namespace sf::sensors {

inline constexpr AccuracyMode kLaserModes[] = {
    {"exact", "every beam, decided and measured in 64 bits"},
    {"single", "every beam, decided in 64 bits, measured in 32 bits where these are accurate enough"},
    {"skip2", "every 2nd beam; the others interpolated between the hits"},
    {"skip4", "every 4th beam"},
    {"skip8", "every 8th beam"},
};

/// A laser with the settings that its beams are cast with.
struct CastLaser {
  LaserSettings laser;        ///< `resolution` includes that of its mode
  bool single = false;        ///< raycast::Scanner::single
  std::uint8_t mode = 0;      ///< row of `kLaserModes`
  std::vector<double> sines;  ///< of 0, 1, ... `resolution` sample steps, to interpolate along straight lines between
                              ///< hits; empty: ranges are interpolated linearly
};
CastLaser cast_laser(const world::World& world, const LaserSettings& laser);

/// Returns the pose of the laser of a reading in its mover's frame.
base::RigidTransform laser_mount(const SensorSet& sensor_set, const base::ReadingBlock& reading);

/// Largest dimensions of a world, including movers.
struct Reaches {
  double longest = 0.0;   ///< [m] longest surface
  double farthest = 0.0;  ///< [m] largest coordinate
};
Reaches reaches_of(const world::World& world);

/// Returns base::ReadingBlock::bound of a laser [m].
/// @param single CastLaser::single  @param longest [m] longest surface
/// @param farthest [m] largest coordinate of anything in range
double laser_bound(double range_max, bool single, double longest, double farthest);

/// Implements `SensorType::bound`.
ErrorBound bound_of_laser(const world::World& world, const ParsedSensors& sensors, std::size_t row);

}  // namespace sf::sensors
