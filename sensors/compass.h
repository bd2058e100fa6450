#pragma once
// Compasses: the Earth's magnetic field and the heading against magnetic north (docs/inertial.md).
//
// In a world file, inside a robot:
//   compass( strength 4.9e-5  inclination 66  declination 3  hard_iron [2e-6 0 0]  noise 3e-7 )
// `inclination`: downwards. `declination`: of magnetic north, to the east of north, which is the world's y.
// `hard_iron`: field of the robot's magnets [T]; `soft_iron`: [xx yy zz xy xz yz], by which its iron changes the field,
// both in the sensor's frame.
//
// A reading is one row: the magnitude of the field [T], the field in the sensor's frame [T], and the heading of the
// sensor's x axis that its x and y give, clockwise from magnetic north [rad], as of a level compass.

#include "sensors/triad_backend.h"

namespace sf::sensors {

inline constexpr std::uint8_t kCompass = 47;  ///< wire id

/// Settings of one compass.
struct Compass {
  TriadInstrument instrument;  ///< [T]
  glm::dvec3 field_W;          ///< [T] in the world: x east, y north
  glm::dvec3 hard_iron;        ///< [T] in the sensor's frame
  glm::dmat3 soft_iron{1.0};   ///< the field in the sensor's frame is multiplied by it
};

/// @param earth field of the world [T], which each of the three settings of the field overrides; 0: none
/// @throws base::InputError with file and line.
Compass read_compass(const world::Sensor& sensor, const glm::dvec3& earth, SensorSpec& row);

extern const SensorType compass_type;

}  // namespace sf::sensors
