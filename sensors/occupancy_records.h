#ifndef SENSORS_OCCUPANCY_RECORDS_H
#define SENSORS_OCCUPANCY_RECORDS_H
// What host and device agree on about occupancy maps. Read by both compilers.
//
// Lines that are longer along columns than along rows ("flat") cover one cell of each column they cross, the others
// ("steep") one cell of each row. So cells are covered strip by strip: a flat strip is 32 cells of one column, a steep
// strip 32 cells of one row. Lanes come in blocks of eight neighbours: eight strips, or eight words of a map.

#define SF_MAP_BLOCK 8
#define SF_MAP_ROW_TEXELS 7
#define SF_ODDS_TEXELS 2 /* a word's sixteen log odds, 16 bits each */
#define SF_STRIP 32
#define SF_STEEP 0x80000000u  /* in MapBlock::row, of a block of steep strips */
#define SF_STEEP_REACH 2048.0 /* added to the reach of a steep line */

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// Where the strips of one scan lie: those of `chunk` are `pitch` words in their table, from column (or row) `low` on.
struct StripTable {
  std::uint32_t first;
  std::uint32_t pitch;
  std::uint32_t low;    ///< column of flat, row of steep strips
  std::uint32_t chunk;  ///< first, in SF_STRIP rows (columns)
};
static_assert(sizeof(StripTable) == 16);

/// One scan and the map that it is entered into. Seven texels of 16 bytes.
struct MapRow {
  std::uint32_t words;         ///< the map's first word in the table of all maps
  std::uint32_t word_columns;  ///< in a row of it
  std::uint32_t box_right;     ///< [words] end of the box along x; 0: nobody's row, whose lanes do nothing
  std::uint32_t pairs;         ///< of beams
  std::uint32_t lines;         ///< its first pair in the table of lines
  std::int32_t column;         ///< of the sensor's cell, which may lie beside the map
  std::int32_t row;
  std::uint32_t spare;
  float within_x;  ///< [cells] of the sensor from the middle of its cell, along columns
  float within_y;  ///< likewise along rows
  float heading;   ///< [rad] in [-pi, pi]
  float spare2;
  float half_fov;    ///< [rad]
  float per_radian;  ///< [pairs of beams/rad]
  float slack;       ///< [rad] by which bearings may be wrong
  float round;       ///< [pairs of beams] of a whole turn
  std::int32_t hit;  ///< log odds: see maps::LogOddsUpdate
  std::int32_t miss;
  std::int32_t limit;
  std::uint32_t spare3;
  StripTable flat;
  StripTable steep;
};
static_assert(sizeof(MapRow) == SF_MAP_ROW_TEXELS * 16);

/// A beam as its line: how it goes to the side, and how far it goes.
struct BeamLine {
  float slope;  ///< rows for each column, or of steep lines columns for each row, in [-1, 1]
  float reach;  ///< [cells] along, with its sign; of steep lines SF_STEEP_REACH more (or less). 0: covers nothing else
};
static_assert(sizeof(BeamLine) == 8);

/// Eight words of one map, or eight strips: two words.
struct MapBlock {
  std::uint32_t row;    ///< MapRow
  std::uint32_t place;  ///< low 16 bits: first column (of words; of cells) or first row; high: row of words, or chunk
};
static_assert(sizeof(MapBlock) == 8);

}  // namespace sf::sensors

#endif
#endif
