#ifndef SENSORS_CONES_RECORDS_H
#define SENSORS_CONES_RECORDS_H
// Records of cones of beams, whose nearest echo is a reading, for host and device. cmake/records.awk writes the
// accessors of kernels.

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// One cone that is due.
struct ConeRow {
  std::uint32_t lane;        ///< first of its lanes in the results of the cast
  std::uint32_t lanes;       ///< number of its lanes
  std::uint32_t directions;  ///< first lane of its beams' directions
  float min_cosine;          ///< least cosine of an angle of incidence that returns an echo; 0: any angle
  float heading_cos, heading_sin;
  double range_max;  ///< [m] range without an echo
};

/// The nearest echo of a cone.
struct ConeEcho {
  double range;       ///< [m] of the nearest surface that returns an echo; range_max without one
  std::uint32_t hit;  ///< `Segment::model` in the cast, or SF_NO_HIT
  std::uint32_t spare;
};

/// Direction of a surface.
struct ReflectorDirection {
  float along_x, along_y;  ///< unit vector in the frame of its mover, or of the world
  std::uint32_t heading;   ///< row of the headings: 0: static; 1 + mover
  std::uint32_t spare;
};

}  // namespace sf::sensors

#endif
#endif
