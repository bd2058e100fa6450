#pragma once
// The magnetometer array: up to 16 elements, each of which reads the field of all magnets where it is
// (docs/magnets.md).
//
// In a world file, inside a robot:
//   magnetometer( scount 5  spose[0] [x y yaw] ... spose[4] [x y yaw]  ssensitivity [min max]  noise [sigma]
//                 sum "vector" )
// Elements are in the frame of their model and keep the order of the file. They stand at half its height, and spose3
// ([x y z yaw]) lifts them from there. Sensitivity and noise are in Gauss.
//
// A reading has four columns for each element: the field (the vector's length, or with `sum "magnitude"` the sum of the
// magnets' own), and the vector in the element's own frame. Noise is normal on each component, before the length is
// taken; then all four saturate at the sensitivity. A robot's own magnets count as any other's.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kMagnetometer = 3;          ///< wire id
inline constexpr std::uint32_t kMostElements = 16;        ///< of one array
inline constexpr double kGauss = 1e-4;                    ///< [T]
inline constexpr std::uint32_t kMagnetometerColumns = 4;  ///< numbers of one element: field, x, y, z [T]

/// What a world file says of one array.
struct Magnetometer {
  std::vector<Pose> X_SE;   ///< of each element in the sensor's frame, whose origin is at half the model's height
  double least = 0.0;       ///< [T] nothing reads less
  double most = 0.0;        ///< [T] nothing reads more; > least
  bool magnitudes = false;  ///< the field is the sum of the magnets' magnitudes, not the length of their vectors' sum
  double sigma = 0.0;       ///< [T] of each component's noise
};

/// @throws base::InputError with file and line.
Magnetometer read_magnetometer(const world::Sensor& sensor);

extern const SensorType magnetometer_type;

}  // namespace sf::sensors
