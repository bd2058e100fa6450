#pragma once
// Barometric altimeters: height above a datum (docs/inertial.md).
//
// In a world file, inside a robot:
//   altimeter( datum 0  noise 0.1  bias 2  walk 0.03  step 0.01 )
// A reading is one row: the height in metres.

#include "sensors/triad_backend.h"

namespace sf::sensors {

inline constexpr std::uint8_t kAltimeter = 48;  ///< wire id

/// Settings of one altimeter.
struct Altimeter {
  TriadInstrument instrument;  ///< [m]
  double datum = 0.0;          ///< [m] height in the world that reads 0
};

extern const SensorType altimeter_type;

}  // namespace sf::sensors
