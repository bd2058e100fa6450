#ifndef SENSORS_LANEEDGE_H
#define SENSORS_LANEEDGE_H
// The lane edge sensor: a fan of rays that meets road paint, a line through the points, and how far away that line is
// along a fixed bearing of the robot. docs/laneedge.md defines every word of it.
//
// What host and device agree on. Read by both compilers.

// What a ray met, as the excerpt of the world (sensors/lane_markings/filtered_scene.h) and the raster name it: flags
// below a grain, the row of a table of pixel sizes in rising order. Row 0: no pixels, an exact outline.
#define SF_TAG_END 1u
#define SF_TAG_MOVER 2u
#define SF_TAG_BITS 2

#define SF_EDGE_TEXELS 6
#define SF_READING_TEXELS 3
#define SF_EDGE_PACKED 1u
#define SF_EDGE_SINGLE 2u
#define SF_EDGE_CAST 4u

// [m] where rays lie that are no points.
#define SF_NOWHERE 1e18
// A point's grain, in the last bits of its x: 6e-14 of it.
#define SF_GRAIN_MASK 0xFFu

#define SF_RASTER_TEXELS 5

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

inline constexpr std::uint8_t kLaneEdge = 2;  ///< on the wire

/// One sensor that is due, as the fit sees it. All vectors are in the sensor's own frame.
struct EdgeRow {
  std::uint32_t lane;        ///< first of its lanes among the results of the cast
  std::uint32_t directions;  ///< first lane of its nominal bearings
  std::uint32_t beams;       ///< in [1, kMostEdgeSamples]
  std::uint32_t flags;       ///< SF_EDGE_PACKED, SF_EDGE_SINGLE
  double perpendicular_x;    ///< unit vector along which the distance is meant
  double perpendicular_y;
  double range_limit;         ///< [m] ranges from here on are "near the maximum": no points
  double range_min;           ///< [m] ranges up to here are no points, where it is not 0
  double range_sigma;         ///< [m] noise, as in world::LaserNoise
  double range_proportional;  ///< [-]
  double angle_sigma;         ///< [rad]
  double distance_max;        ///< [m] an edge farther away is out of sight
  std::uint32_t noise;        ///< first lane of its normal deviates
  std::uint32_t out;          ///< row of its reading
  float noise_share;          ///< 1: ranges are disturbed; 0: they are not
  float range_max;            ///< [m]
};
static_assert(sizeof(EdgeRow) == SF_EDGE_TEXELS * 16);

/// One sensor that is due, as the raster of the road sees it.
struct RasterRow {
  std::int32_t column, row;  ///< cell of the raster that the sensor stands in; -1 where it is too far from all paint
  float x, y;                ///< [cells] where in that cell, in [0, 1]
  double heading_cos, heading_sin;
  std::uint32_t lane;           ///< first of its lanes of results, here and among the results of the cast
  std::uint32_t beams;          ///< first lane of its beams' directions
  std::uint32_t flags;          ///< SF_EDGE_CAST
  float reach;                  ///< [cells] range_max
  double cell;                  ///< [m]
  double range_max;             ///< [m]
  std::uint32_t tag;            ///< of paint
  std::uint32_t columns, rows;  ///< [blocks] of the raster
  std::uint32_t spare;
};
static_assert(sizeof(RasterRow) == SF_RASTER_TEXELS * 16);

/// Loops of one invocation together stay below the 65 535 turns after which older Mesa ends them silently.
inline constexpr std::uint32_t kMostEdgeSamples = 1'024;

/// What a reading says, one row of four columns, and how good it is.
struct EdgeReading {
  double distance;      ///< [m] to the paint's face; NaN: no edge in sight
  double points;        ///< that the line rests on
  double residual;      ///< [m] their root mean square distance from the line
  double sigma;         ///< [m] standard deviation of the distance; NaN with it
  double gain = 0.0;    ///< [-] the distance is off by at most so many times what its points are; SF_NO_GAIN: not known
  double others = 0.0;  ///< points that are not on the line
};
static_assert(sizeof(EdgeReading) == SF_READING_TEXELS * 16);

}  // namespace sf::sensors

#endif
#endif
