#pragma once
// Wheel encoders of a robot with left and right wheels (docs/sensors.md).
//
// In a world file, inside a robot:
//   encoder( per_count length  slip 0.005  scale [left right]  track length  scrub 1.5 )
// `per_count`: distance that a wheel rolls per count. `slip`: standard deviation of the error after one metre; it grows
// with the square root of the distance. `scale`: factor on each wheel's counts. `track`: distance between the wheels
// (default: the robot's). `scrub`: factor on the track when wheels scrub sideways in turns (default: 1.5 for skid
// steering, else 1). `slip_ratio` [left right]: part of each wheel's way that the robot does not advance; `slope_slip`:
// more of it per unit of slope, uphill.
//
// Cars with `dynamics "car"` report the rotation of their driven wheels, which is counted in place of the path: the
// wheels spin and lock. They have no `slip_ratio` and no `slope_slip`.
//
// A reading is one row: distance rolled by the left and the right wheel since the start, in metres and in counts,
// forward positive. A displacement of more than 0.5 m plus twice the distance possible at the robot's top speed is a
// relocation and is not counted.

#include <cstdint>

#include "sensors/odometer.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kEncoder = 8;  ///< wire id

/// Encoder settings of one robot.
struct Encoder {
  double per_count = 1e-3;   ///< [m] > 0
  double angle_step = 0.0;   ///< [rad] > 0: a real robot's odometry, which reports distance and angle in such steps
  double slip = 0.0;         ///< [m^(1/2)] >= 0
  double scale_left = 1.0;   ///< [-] > 0
  double scale_right = 1.0;  ///< [-] > 0
  double track = 0.3;        ///< [m] > 0, effective: including scrub
  double slip_ratio_left = 0.0, slip_ratio_right = 0.0;  ///< [-] in [-kMostSlip, kMostSlip]
  double slope_slip = 0.0;                               ///< [-] in [0, 10] added per sine of the slope
};

/// The wheels of one robot, as its encoders count them.
struct Wheels {
  Wheels(const Encoder& encoder, const base::RandomKey& walk, bool noise)
      : settings(encoder), left(walk, 0, noise ? encoder.slip : 0.0), right(walk, 1, noise ? encoder.slip : 0.0) {}

  /// Adds the motion between two poses. @param slip world::Variation::slip
  /// @param rise [m] height gained on a slope
  void roll(const base::Pose& before, const base::Pose& after, double slip = 0.0, double rise = 0.0);
  /// Adds ways of the wheels [m].
  void add(const Rolled& step);
  /// Returns the distances in counts, with scale, slip and rounding.
  Rolled counts() const;
  /// Returns the distances [m] that the counts state.
  Rolled counted() const { return {counts().left * settings.per_count, counts().right * settings.per_count}; }

  Encoder settings;
  Rolled rolled;  ///< [m] since the start, true ways of the wheels
  Slippage left;
  Slippage right;
};

/// @throws base::InputError with file and line.
Encoder read_encoder(const world::Sensor& sensor, const world::Mover& mover);

extern const SensorType encoder_type;

}  // namespace sf::sensors
