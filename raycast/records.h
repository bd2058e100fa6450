#ifndef RAYCAST_RECORDS_H
#define RAYCAST_RECORDS_H
// What host and device agree on about casting rays. Read by both compilers.
//
// A lane owns four adjacent beams of one sensor, so that each segment it loads serves four.
// A sector list holds the segments that beams of one direction sector may meet from anywhere in one cell, near to far,
// in chunks of four; coordinates are relative to the cell's centre.

#define SF_SECTORS 32
#define SF_CHUNK 4
#define SF_BEAMS_PER_LANE 4
#define SF_ROW_TEXELS 6
#define SF_NO_HIT 0xFFFFFFFFu

// A list names a segment by its row (24 bits) and by how clear of others it is (8 bits above them): code k is 2^-k
// metres, 127 nothing at all.
#define SF_ROW_BITS 24
#define SF_ROW_MASK 0xFFFFFFu
#define SF_NO_CLEARANCE 127

// The verdict of a lane on its beams, shifted by each one's place in the lane: it meets what it met at too small an
// angle; and 32 bits could not prove what it meets first.
#define SF_GRAZES 1u
#define SF_DOUBT 16u

// A range measured in 32 bits is taken when its bounds are closer together than this share of the sensor's reach.
#define SF_SINGLE_SHARE 2.44140625e-4 /* 2^-12 */

// What a 32-bit search may be wrong by, as a share of the largest coordinate (sectors.h derives it).
#define SF_BAND 9.5367431640625e-7 /* 2^-20 */

// A surface within this distance [m] along the beam counts as touching the sensor: beams into it read 0, beams off it
// pass.
#define SF_TOUCH 1e-9

#ifdef __cplusplus

#include <cstdint>

namespace sf::raycast {

/// One sensor that is due: where it looks from and which tables serve it. Six texels of 16 bytes.
struct RayRow {
  float offset_x;  ///< [m] sensor relative to the centre of its cell
  float offset_y;
  float mover_offset_x;  ///< [m] sensor relative to what the movers' lists are relative to
  float mover_offset_y;
  float heading_sectors;      ///< [sectors] yaw in [0, SF_SECTORS)
  float band;                 ///< [m] SF_BAND times the largest coordinate in its lists
  float reach;                ///< [m] range_max and a little: nothing farther matters
  float least_sine;           ///< a beam that meets a surface at a smaller angle is said to graze it
  std::uint32_t wall_lists;   ///< first of SF_SECTORS list headers
  std::uint32_t mover_lists;  ///< first of SF_SECTORS list headers
  std::uint32_t beams;        ///< first lane in the beam tables
  std::uint32_t out;          ///< first lane in the result tables
  double origin_x;            ///< [m] world
  double origin_y;
  double heading_cos64;
  double heading_sin64;
  double range_max;  ///< [m]
  double range_min;  ///< [m]
};
static_assert(sizeof(RayRow) == SF_ROW_TEXELS * 16);

/// One sector list: where it is and how close together the things in it may come.
struct ListHeader {
  std::uint32_t first;   ///< chunk
  std::uint32_t count;   ///< [chunks] of segments that face viewpoints
  float clearance;       ///< [m] movers: none of it is nearer to a wall; walls: +inf
  std::uint32_t behind;  ///< [chunks] that follow, of segments that face none: they only decide ties at corners
};
static_assert(sizeof(ListHeader) == 16);

/// A segment as the search sees it: start and extent, relative to the cell's centre, seen from its right.
struct ListEntry {
  float ax, ay;  ///< [m]
  float ex, ey;  ///< [m]
};
static_assert(sizeof(ListEntry) == 16);

/// A segment as the decision sees it: two texels.
struct ExactSegment {
  double ax, ay, bx, by;  ///< [m] world
};
static_assert(sizeof(ExactSegment) == 32);

/// Whose beams a lane casts: two words.
struct Lane {
  std::uint32_t row;   ///< of the due sensor
  std::uint32_t lane;  ///< within the sensor
};
static_assert(sizeof(Lane) == 8);

}  // namespace sf::raycast

#endif
#endif
