#ifndef SENSORS_OWN_SENSOR_RECORDS_H
#define SENSORS_OWN_SENSOR_RECORDS_H
// Records of users' own kernels, for host and device. cmake/records.awk generates the kernels' accessors.

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// One sensor that is due.
struct OwnSample {
  double x;  ///< [m] world
  double y;
  double z;
  double yaw;              ///< [rad]
  double parameters[4];    ///< sensorfarm::Sensor::parameters
  double more[4];          ///< last four of the parameters
  std::uint32_t elements;  ///< of its reading
  std::uint32_t lanes;     ///< invocations per sensor: elements of the longest reading
  std::uint32_t surfaces;  ///< rows in the table of surfaces
  std::uint32_t columns;   ///< numbers per element
  std::uint32_t mover;     ///< the sensor's robot
  std::uint32_t sequence;  ///< number of its reading
  std::uint32_t spare;
  std::uint32_t spare2;
};

/// One segment that lasers detect.
struct OwnSurface {
  double ax;  ///< [m] world
  double ay;
  double bx;
  double by;
  double z_min;         ///< [m] lowest height at which it is visible
  double z_max;         ///< [m] exclusive upper limit of these heights
  std::uint32_t model;  ///< `Segment::model`
  std::uint32_t mover;  ///< mover that carries it; 0xFFFFFFFF: a wall
  std::uint32_t spare;
  std::uint32_t spare2;
};

}  // namespace sf::sensors

#endif
#endif
