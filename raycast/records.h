#ifndef RAYCAST_RECORDS_H
#define RAYCAST_RECORDS_H
// Records and constants of ray casting, shared by host and device. cmake/records.awk generates the kernels' accessors
// from the structs.
//
// A lane is one invocation with four adjacent beams of a sensor, so each loaded segment is tested against four beams. A
// list contains the segments that beams in one sector of directions may meet, near to far, in chunks of four.

#define SF_SECTORS 32
#define SF_CHUNK 4
#define SF_BEAMS_PER_LANE 4
#define SF_LANES_PER_GROUP 64  // in every kernel that is dispatched over lanes
#define SF_NO_HIT 0xFFFFFFFFu

// Flags of a lane, shifted left by the beam's place in the lane. SF_GRAZING: the beam grazes its surface. SF_UNCERTAIN:
// 32 bits could not certify its nearest surface.
#define SF_GRAZING 1u
#define SF_UNCERTAIN 16u

// Uncertain lanes are dispatched in rows of this many groups.
#define SF_UNCERTAIN_GROUPS_ACROSS 64u

// A beam grazes a surface if the sine of the angle between them is below this value.
#define SF_MIN_SINE 1e-3

// A 32-bit range is used if its lower and upper bounds differ by less than this fraction of range_max; otherwise the
// range is computed in 64 bits.
#define SF_SINGLE_TOLERANCE 2.44140625e-4 /* 2^-12 */

// Relative error of 32-bit coordinates, in units of the largest one, A. With directions d of unit length and u = 2^-24,
// end points and offsets have rounding errors of u A, directions of 4 u; products and differences add u A each:
//   |error of w x d| < 10 u A, |error of e x d| < 10 u |e|, |error of e x w| < 10 u A |e|.
#define SF_COORDINATE_ERROR 9.5367431640625e-7 /* 2^-20 */

// Contact distance [m] along the beam: a nearer surface touches the sensor. Beams that enter the surface read 0; beams
// that leave it are not affected.
#define SF_CONTACT_DISTANCE 1e-9

#ifdef __cplusplus

#include <cstdint>

namespace sf::raycast {

/// Pose and tables of one due sensor.
struct RayRow {
  float offset_x;  ///< [m] sensor relative to the centre of its cell
  float offset_y;
  float heading_sectors;  ///< [sectors] yaw in [0, SF_SECTORS)
  float band;             ///< [m] SF_COORDINATE_ERROR times the largest coordinate in its lists
  std::uint32_t walls;    ///< first of SF_SECTORS list heads
  std::uint32_t movers;   ///< first of SF_SECTORS list heads
  std::uint32_t beams;    ///< first lane in the beam tables
  std::uint32_t results;  ///< first lane in the result tables
  double origin_x;        ///< [m] world
  double origin_y;
  double heading_cos64;
  double heading_sin64;
  double range_max;  ///< [m]
  double range_min;  ///< [m]
};

/// One sector's list. List heads, chunks and entries are texels of one table.
struct ListHead {
  std::uint32_t first;        ///< texel of the first chunk
  std::uint32_t count;        ///< [chunks] of front-facing segments
  std::uint32_t back_facing;  ///< [chunks] of back-facing segments, which follow; needed only for ties at corners
  std::uint32_t base;         ///< texel of the walls' entries
};

/// Four entries of a list.
struct ListChunk {
  float nearest;                    ///< [m] lower bound of the distance of these entries and all that follow
  std::uint32_t mover;              ///< 0: walls; otherwise 1 + the mover's row in the table of `MoverRow`
  std::uint16_t entries[SF_CHUNK];  ///< relative to the first entry of the walls or the mover
};

/// Pose and outline of a mover at one height.
struct MoverRow {
  double x, y;              ///< [m] world
  float cos, sin;           ///< of its heading
  std::uint32_t base;       ///< texel of its outline's entries
  std::uint32_t first_row;  ///< of its exact segments
};

/// A segment for the 32-bit search, visible from its right, in the frame of the cell or the mover.
struct ListEntry {
  float x, y;    ///< [m] midpoint
  float ex, ey;  ///< [m] from the midpoint to its end
};

/// A segment for the 64-bit intersection.
struct ExactSegment {
  double ax, ay, bx, by;  ///< [m] world
};

/// The ranges of a lane.
struct LaneRanges {
  double range[SF_BEAMS_PER_LANE];  ///< [m]
};

/// The hits of a lane.
struct LaneHits {
  std::uint32_t model[SF_BEAMS_PER_LANE];  ///< `Segment::model`; SF_NO_HIT: none
};

/// A unit vector.
struct BeamDirection {
  double cos, sin;
};

/// The beams of one invocation.
struct Lane {
  std::uint32_t row;   ///< row of the due sensor
  std::uint32_t lane;  ///< within the sensor
};

/// One due cone of beams.
struct ConeRow {
  std::uint32_t lane;        ///< first of its lanes in the results of the cast
  std::uint32_t lanes;       ///< number of its lanes
  std::uint32_t directions;  ///< first lane of its beams' directions
  float min_cosine;          ///< smallest cosine of an angle of incidence that returns an echo; 0: any angle
  float heading_cos, heading_sin;
  double range_max;  ///< [m] reading without an echo
};

/// The nearest echo of a cone.
struct ConeEcho {
  double range;       ///< [m] of the nearest surface that returns an echo; range_max if there is none
  std::uint32_t hit;  ///< `Segment::model` in the cast, or SF_NO_HIT
  std::uint32_t spare;
};

/// Direction of a surface that reflects sound.
struct ReflectorDirection {
  float along_x, along_y;  ///< unit vector in the frame of its mover, or of the world
  std::uint32_t heading;   ///< row in the table of headings; 0: static, otherwise 1 + mover
  std::uint32_t spare;
};

}  // namespace sf::raycast

#endif
#endif
