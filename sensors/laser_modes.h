#pragma once
// The laser's modes: what each casts, and what it may be wrong by.

#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr AccuracyMode kLaserModes[] = {
    {"exact", "every beam, decided and measured in 64 bits"},
    {"single", "every beam, decided exactly, measured in 32 bits where these are close enough"},
    {"skip2", "every 2nd beam; the others on straight lines between what these met"},
    {"skip4", "every 4th beam"},
    {"skip8", "every 8th beam"},
};

/// A laser as it is cast.
struct CastLaser {
  world::Laser laser;         ///< its `resolution` is that of its mode as well
  bool single = false;        ///< raycast::Fan::single
  std::uint8_t mode = 0;      ///< row of `kLaserModes`
  std::vector<double> sines;  ///< of 0, 1, ... `resolution` steps between samples, where those between two beams lie on
                              ///< the straight line between what these met; empty: on that between their ranges
};
CastLaser cast_laser(const world::World& world, const world::Laser& laser);

/// What is met may be so large and so far away, all movers included.
struct Reaches {
  double longest = 0.0;   ///< [m] surface
  double farthest = 0.0;  ///< [m] coordinate
};
Reaches reaches_of(const world::World& world);

/// [m] base::ReadingBlock::bound of a laser. @param farthest [m] coordinate of anything in range
double laser_bound(const CastLaser& laser, double longest, double farthest);

ErrorBound bound_of_laser(const world::World& world, const SensorSpec& sensor);

}  // namespace sf::sensors
