#pragma once
// Wheel encoders of a robot with a left and a right wheel, or a left and a right row of them (docs/sensors.md).
//
// In a world file, inside a robot:
//   encoder( per_count length  slip 0.005  scale [left right]  track length  scrub 1.5 )
// `per_count` is how far a wheel rolls from one count to the next; `slip` the standard deviation of the miscounted way
// after one metre, which grows with its root; `scale` what each wheel's counts are too large by, as a factor; `track`
// between the wheels (else the robot's); `scrub` how much wider it seems where wheels scrub sideways in turns (1.5
// where the robot skids, else 1).
//
// A reading is one row: what the left and the right wheel rolled since the start, in metres and in counts, forwards
// positive. What moves a robot farther in a tick than it can drive puts it elsewhere, and is not counted.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kEncoder = 8;  ///< wire id

/// What a world file says of one robot's encoders.
struct Encoder {
  double per_count = 1e-3;   ///< [m] > 0
  double slip = 0.0;         ///< [m^(1/2)] >= 0
  double scale_left = 1.0;   ///< [-] > 0
  double scale_right = 1.0;  ///< [-] > 0
  double track = 0.3;        ///< [m] > 0, as the wheels see it: scrub included
};

/// @throws base::InputError with file and line.
Encoder read_encoder(const world::Sensor& sensor, const world::Mover& mover);

extern const SensorType encoder_type;

}  // namespace sf::sensors
