#pragma once
// World-file settings of sonar and infrared, the sensor types with cones.
//
//   sonar( scount N  spose[i] [x y yaw] ...  fov 25  range [min max]  rays 11  noise [constant proportional] )
//
// Transducers are in the frame of their model, at half its height. spose3 [x y z yaw] adds a height.

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostTransducers = 64;  ///< per sensor
inline constexpr std::uint32_t kMostConeRays = 1'025;  ///< per cone
/// One sensor: its transducers and the settings of their cones.
struct ConeArray {
  SensorSpec row;          ///< X_MS at half the model's height
  std::vector<Pose> X_SC;  ///< per transducer, in the sensor frame; the cone's axis is x
  double fov = 0.0;        ///< [rad] aperture of a cone, in [0, 2 pi]
  std::uint32_t rays = 1;  ///< per cone: odd, so that one ray lies on the axis
  double range_min = 0.0;  ///< [m] in [0, range_max)
  double range_max = 0.0;  ///< [m] > 0
  /// Readings per firing cycle: reading k fires the transducers whose index is congruent to k modulo `turns`.
  std::uint32_t turns = 1;
  double min_cosine = 0.0;    ///< smallest cosine of an angle of incidence that returns an echo; 0: any angle
  double sigma = 0.0;         ///< [m] constant part of the noise
  double proportional = 0.0;  ///< [-] noise per metre of range; its use depends on the sensor type
};

/// Defaults of a sensor type's cones.
struct ConeDefaults {
  double fov;        ///< [rad]
  double range_min;  ///< [m]
  double range_max;  ///< [m]
  double rate;       ///< [Hz]
};

/// Reads all settings except turns, incidence and noise.
/// @throws base::InputError with file and line.
ConeArray read_cones(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type,
                     const ConeDefaults& defaults);

/// Returns all sensors of `type` in a world, by mover and in file order, using `read` for each.
using ReadConeArray = ConeArray (*)(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type);
std::vector<ConeArray> cone_arrays_of(const world::World& world, std::string_view type, ReadConeArray read);

}  // namespace sf::sensors
