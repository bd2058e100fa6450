#ifndef SENSORS_LANEEDGE_H
#define SENSORS_LANEEDGE_H
// The lane edge sensor: the distance along a fixed bearing of the robot to a line fitted to the points where a scan
// hits road markings. docs/laneedge.md defines all terms.
//
// Records for host and device: cmake/records.awk generates the kernels' accessors from the structs.

// Tag of a hit, from the filtered scene (sensors/lane_markings/filtered_scene.h) or the raster: two flags, then the row
// in the ascending table of pixel sizes. Row 0 is an exact outline without pixels.
#define SF_TAG_END 1u
#define SF_TAG_MOVER 2u
#define SF_TAG_BITS 2

#define SF_EDGE_PACKED 1u
#define SF_EDGE_SINGLE 2u
#define SF_EDGE_CAST 4u

// [m] coordinate of beams that yield no point.
#define SF_NOWHERE 1e18
// The row of a point's pixel size, stored in the last bits of its x, which change x by a relative 6e-14.
#define SF_GRAIN_MASK 0xFFu

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

inline constexpr std::uint8_t kLaneEdge = 2;  ///< wire id

/// One due sensor for the fit. Vectors are in the sensor frame.
struct EdgeRow {
  std::uint32_t lane;        ///< its first lane in the results of the cast
  std::uint32_t directions;  ///< first lane of its nominal bearings
  std::uint32_t beams;       ///< in [1, kMostEdgeSamples]
  std::uint32_t flags;       ///< SF_EDGE_PACKED, SF_EDGE_SINGLE
  double perpendicular_x;    ///< unit vector: the direction of the distance
  double perpendicular_y;
  double range_limit;         ///< [m] ranges from this value on are "near the maximum" and yield no points
  double range_min;           ///< [m] ranges up to this value yield no points, unless it is 0
  double range_sigma;         ///< [m] noise, as in raycast::ScanNoise
  double range_proportional;  ///< [-]
  double angle_sigma;         ///< [rad]
  double distance_max;        ///< [m] a farther edge is out of sight
  std::uint32_t noise;        ///< first lane of its normal deviates
  std::uint32_t reading;      ///< row of its reading
  float noise_share;          ///< 1: ranges have noise; 0: they have none
  float range_max;            ///< [m]
};

/// The point that a beam hit, in the sensor frame. The row of its pixel size is in the last bits of x (SF_GRAIN_MASK).
struct EdgePoint {
  double x, y;  ///< [m]
};

/// A pixel size of road markings.
struct Grain {
  double size;  ///< [m]
  double spare;
};

/// One due sensor for the road raster.
struct RasterRow {
  std::int32_t column, row;  ///< raster cell of the sensor; -1 if it is too far from all paint
  float x, y;                ///< [cells] position in that cell, in [0, 1]
  double heading_cos, heading_sin;
  std::uint32_t lane;           ///< its first result lane, here and in the results of the cast
  std::uint32_t beams;          ///< first lane of its beams' directions
  std::uint32_t flags;          ///< SF_EDGE_CAST
  float reach;                  ///< [cells] range_max
  double cell;                  ///< [m]
  double range_max;             ///< [m]
  std::uint32_t tag;            ///< tag of paint
  std::uint32_t columns, rows;  ///< [blocks] of the raster
  std::uint32_t spare;
};

/// All loops of one invocation together stay below 65 535 iterations, after which older Mesa silently ends them.
inline constexpr std::uint32_t kMostEdgeSamples = 1'024;

/// A reading: one row of four columns, and its quality.
struct EdgeReading {
  double distance;      ///< [m] to the edge of the marking; NaN: no edge in sight
  double points;        ///< number of points on the line
  double residual;      ///< [m] root mean square distance of these points from the line
  double sigma;         ///< [m] standard deviation of the distance; NaN if the distance is NaN
  double gain = 0.0;    ///< [-] largest error of the distance per error of its points; SF_NO_GAIN: unknown
  double others = 0.0;  ///< number of points off the line
};

}  // namespace sf::sensors

#endif
#endif
