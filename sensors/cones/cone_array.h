#pragma once
// What a world file says of sensors that look along cones: sonar and infrared.
//
//   sonar( scount N  spose[i] [x y yaw] ...  fov 25  range [min max]  rays 11  noise [constant proportional] )
//
// Transducers are in the frame of their model, at half its height (spose3 [x y z yaw] lifts them from there).

#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint32_t kMostTransducers = 64;  ///< of one sensor
inline constexpr std::uint32_t kMostConeRays = 1'025;  ///< of one cone
/// One sensor: its transducers and what their cones are like.
struct ConeArray {
  SensorSpec row;          ///< X_MS at half of the model's height
  std::vector<Pose> X_SC;  ///< of each transducer in the sensor's frame; its cone looks along x
  double fov = 0.0;        ///< [rad] of a cone, in [0, 2 pi]
  std::uint32_t rays = 1;  ///< of a cone: odd, so that one looks along its axis
  double range_min = 0.0;  ///< [m] in [0, range_max)
  double range_max = 0.0;  ///< [m] > 0
  /// Readings until every transducer has fired: reading k fires those whose number leaves the same remainder.
  std::uint32_t turns = 1;
  double min_cosine = 0.0;    ///< of the angle of incidence that is heard; 0: whatever it is
  double sigma = 0.0;         ///< [m] constant part of the noise
  double proportional = 0.0;  ///< [-] part of the noise per metre; or what the kind says
};

/// What a kind's cones are where the file says nothing.
struct ConeDefaults {
  double fov;        ///< [rad]
  double range_min;  ///< [m]
  double range_max;  ///< [m]
  double rate;       ///< [Hz]
};

/// Reads all but turns, incidence and noise.
/// @throws base::InputError with file and line.
ConeArray read_cones(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_kind,
                     const ConeDefaults& defaults);

/// All of a world's sensors called `type`, by mover and in file order, each as `read` understands it.
using ReadConeArray = ConeArray (*)(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_kind);
std::vector<ConeArray> cone_arrays_of(const world::World& world, std::string_view type, ReadConeArray read);

}  // namespace sf::sensors
