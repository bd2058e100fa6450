#ifndef RAYCAST_RECORDS_H
#define RAYCAST_RECORDS_H
// What host and device agree on about casting rays. Read by both compilers.
//
// A lane owns four adjacent beams of one sensor, so that each segment it loads serves four. A list holds the segments
// that beams of one sector of directions may meet, near to far, in chunks of four.

#define SF_SECTORS 32
#define SF_CHUNK 4
#define SF_BEAMS_PER_LANE 4
#define SF_ROW_TEXELS 5
#define SF_NO_HIT 0xFFFFFFFFu

// The verdict of a lane on its beams, shifted by each one's place in the lane: it meets what it met at too small an
// angle; and 32 bits could not prove what it meets first.
#define SF_GRAZING 1u
#define SF_UNCERTAIN 16u

// The sine of the angle below which a beam grazes what it meets.
#define SF_MIN_SINE 1e-3

// A range measured in 32 bits is taken when its bounds are closer together than this share of the sensor's reach.
#define SF_SINGLE_TOLERANCE 2.44140625e-4 /* 2^-12 */

// Error of coordinates in 32 bits, as a share of the largest one, A. With directions d of unit length and u = 2^-24,
// ends and offsets round by u A each, directions by 4 u, products and differences by u A more each:
//   |error of w x d| < 10 u A, |error of e x d| < 10 u |e|, |error of e x w| < 10 u A |e|.
#define SF_COORDINATE_ERROR 9.5367431640625e-7 /* 2^-20 */

// A surface within this distance [m] along the beam counts as touching the sensor: beams into it read 0, beams off it
// pass.
#define SF_CONTACT_DISTANCE 1e-9

#ifdef __cplusplus

#include <cstdint>

namespace sf::raycast {

/// One sensor that is due: where it looks from and which tables serve it. Five texels of 16 bytes.
struct RayRow {
  float offset_x;  ///< [m] sensor relative to the centre of its cell
  float offset_y;
  float heading_sectors;  ///< [sectors] yaw in [0, SF_SECTORS)
  float band;             ///< [m] SF_BAND times the largest coordinate in its lists
  std::uint32_t walls;    ///< first of SF_SECTORS list heads
  std::uint32_t movers;   ///< first of SF_SECTORS list heads
  std::uint32_t beams;    ///< first lane in the beam tables
  std::uint32_t out;      ///< first lane in the result tables
  double origin_x;        ///< [m] world
  double origin_y;
  double heading_cos64;
  double heading_sin64;
  double range_max;  ///< [m]
  double range_min;  ///< [m]
};
static_assert(sizeof(RayRow) == SF_ROW_TEXELS * 16);

/// One sector's list. It is a texel, as chunks and entries are: all lie in one table.
struct ListHead {
  std::uint32_t first;        ///< texel of the first chunk
  std::uint32_t count;        ///< [chunks] of segments that face viewers
  std::uint32_t back_facing;  ///< [chunks] that follow, of segments that face none: they only decide ties at corners
  std::uint32_t base;         ///< texel of the walls' entries
};
static_assert(sizeof(ListHead) == 16);

/// Four entries of a list.
struct ListChunk {
  float nearest;                    ///< [m] least distance of these and all that follow
  std::uint32_t mover;              ///< 0: walls; else one more than the row of the mover's place
  std::uint16_t entries[SF_CHUNK];  ///< counted from the walls' or the mover's first
};
static_assert(sizeof(ListChunk) == 16);

/// Where a mover is, and its outline at one height: two texels.
struct MoverRow {
  double x, y;              ///< [m] world
  float cos, sin;           ///< of its heading
  std::uint32_t base;       ///< texel of its outline's entries
  std::uint32_t first_row;  ///< of its exact segments
};
static_assert(sizeof(MoverRow) == 32);

/// A segment as the search sees it, from its right, in the cell's or the mover's frame.
struct ListEntry {
  float x, y;    ///< [m] middle
  float ex, ey;  ///< [m] from there to its end
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
