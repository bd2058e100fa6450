#pragma once
// The magnetometer array: up to 16 elements, each of which measures the field of all magnets at its position
// (docs/magnets.md).
//
// In a world file, inside a robot:
//   magnetometer( scount 5  spose[0] [x y yaw] ... spose[4] [x y yaw]  ssensitivity [min max]  noise [sigma]
//                 sum "vector" )
// Elements are in the frame of their model and keep the order of the file. They are at half its height; spose3
// ([x y z yaw]) adds a height. Sensitivity and noise are in Gauss.
//
// A reading has four columns per element: the field (length of the vector or, with `sum "magnitude"`, sum of the
// magnitudes of the magnets' fields), and the vector in the element's frame. Noise is normal on each component and is
// added before the length is computed. Then all four columns saturate at the sensitivity. A robot's own magnets are
// included.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kMagnetometer = 3;          ///< wire id
inline constexpr std::uint32_t kMostElements = 16;        ///< per array
inline constexpr double kGauss = 1e-4;                    ///< [T]
inline constexpr std::uint32_t kMagnetometerColumns = 4;  ///< per element: field, x, y, z [T]

/// Settings of one array.
struct Magnetometer {
  std::vector<Pose> X_SE;   ///< per element, in the sensor frame, whose origin is at half the model's height
  double least = 0.0;       ///< [T] lower saturation
  double most = 0.0;        ///< [T] upper saturation; > least
  bool magnitudes = false;  ///< the field is the sum of the magnets' magnitudes, not the length of the vector sum
  double sigma = 0.0;       ///< [T] standard deviation of each component's noise
};

/// @throws base::InputError with file and line.
Magnetometer read_magnetometer(const world::Sensor& sensor);

extern const SensorType magnetometer_type;

}  // namespace sf::sensors
