#ifndef SENSORS_CONES_RECORDS_H
#define SENSORS_CONES_RECORDS_H
// What host and device agree on about cones of beams, whose nearest echo is a reading. Read by both compilers.

#define SF_CONE_TEXELS 2

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// One cone that is due.
struct ConeRow {
  std::uint32_t lane;        ///< first of its lanes among the results of the cast
  std::uint32_t lanes;       ///< of them
  std::uint32_t directions;  ///< first lane of its beams' directions
  float min_cosine;          ///< of the angle of incidence that is heard; 0: whatever it is
  float heading_cos, heading_sin;
  double range_max;  ///< [m] what it reads when it hears nothing
};
static_assert(sizeof(ConeRow) == SF_CONE_TEXELS * 16);

/// What a cone heard.
struct ConeEcho {
  double range;       ///< [m] of the nearest surface heard; range_max when there is none
  std::uint32_t hit;  ///< what it is, in the cast's words, or SF_NO_HIT
  std::uint32_t spare;
};
static_assert(sizeof(ConeEcho) == 16);

/// Which way a surface runs.
struct ReflectorDirection {
  float along_x, along_y;  ///< unit vector in the frame of its mover, or of the world
  std::uint32_t heading;   ///< row of the headings: 0 for what stands still, 1 + mover
  std::uint32_t spare;
};
static_assert(sizeof(ReflectorDirection) == 16);

}  // namespace sf::sensors

#endif
#endif
