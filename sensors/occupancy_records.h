#ifndef SENSORS_OCCUPANCY_RECORDS_H
#define SENSORS_OCCUPANCY_RECORDS_H
// What host and device agree on about occupancy maps. Read by both compilers.
//
// A lane owns one word of a map. Words of the box that a scan speaks of are handed out in blocks: eight neighbours of
// one row of words.

#define SF_MAP_BLOCK 8
#define SF_MAP_ROW_TEXELS 5
#define SF_ODDS_TEXELS 2 /* a word's sixteen log odds, 16 bits each */

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// One map that a scan is entered into. Five texels of 16 bytes.
struct MapRow {
  std::uint32_t words;         ///< its first word in the table of all maps
  std::uint32_t word_columns;  ///< in a row of it
  std::uint32_t box_right;     ///< [words] end of the box along x; 0: a row that is nobody's, whose lanes do nothing
  std::uint32_t beams;
  std::uint32_t ends;   ///< its first beam in the table of ends
  std::int32_t column;  ///< of the sensor's cell, which may lie beside the map
  std::int32_t row;
  std::uint32_t spare;
  float within_x;  ///< [cells] of the sensor from the middle of its cell, along columns
  float within_y;  ///< likewise along rows
  float heading_cos;
  float heading_sin;
  float half_fov;    ///< [rad]
  float per_radian;  ///< [beams/rad]
  float slack;       ///< [rad] by which bearings may be wrong
  float round;       ///< [beams] of a whole turn
  std::int32_t hit;  ///< log odds: see maps::OddsRule
  std::int32_t miss;
  std::int32_t limit;
  std::uint32_t spare2;
};
static_assert(sizeof(MapRow) == SF_MAP_ROW_TEXELS * 16);

/// Eight words of one map: two words.
struct MapBlock {
  std::uint32_t row;    ///< MapRow
  std::uint32_t place;  ///< first word's column (low 16 bits) and row of words (high)
};
static_assert(sizeof(MapBlock) == 8);

}  // namespace sf::sensors

#endif
#endif
