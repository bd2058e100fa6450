#ifndef SENSORS_OCCUPANCY_RECORDS_H
#define SENSORS_OCCUPANCY_RECORDS_H
// Records of occupancy maps, for host and device. cmake/records.awk generates the kernels' accessors.
//
// A line that is longer along columns than along rows ("flat") covers one cell of each column that it crosses. Other
// lines ("steep") cover one cell of each row. So cells are covered strip by strip: a flat strip is 32 cells of one
// column, a steep strip 32 cells of one row. Lanes form blocks of eight neighbours: eight strips, or eight words of a
// map.

#define SF_MAP_BLOCK 8
#define SF_ODDS_TEXELS 2 /* a word's sixteen log odds, 16 bits each */
#define SF_STRIP 32
#define SF_STEEP 0x80000000u  /* in MapBlock::row, of a block of steep strips */
#define SF_STEEP_REACH 2048.0 /* added to the reach of a steep line */

#ifdef __cplusplus

#include <cstdint>

namespace sf::sensors {

/// Layout of one scan's strips: each chunk has `pitch` words in the strip table and starts at column (or row) `low`.
struct StripTable {
  std::uint32_t first;
  std::uint32_t pitch;
  std::uint32_t low;    ///< column of flat, row of steep strips
  std::uint32_t chunk;  ///< first chunk, in SF_STRIP rows (columns)
};

/// One scan and the map that it is added to.
struct MapRow {
  std::uint32_t words;         ///< the map's first word in the table of all maps
  std::uint32_t word_columns;  ///< words per row of the map
  std::uint32_t box_right;     ///< [words] end of the box along x; 0: row for lanes without work
  std::uint32_t pairs;         ///< number of pairs of beams
  std::uint32_t lines;         ///< index of its first pair in the table of lines
  std::int32_t column;         ///< column of the sensor's cell, which may be outside the map
  std::int32_t row;
  std::uint32_t spare;
  float within_x;  ///< [cells] offset of the sensor from the centre of its cell, along columns
  float within_y;  ///< [cells] along rows
  float heading;   ///< [rad] in [-pi, pi]
  float spare2;
  float half_fov;    ///< [rad]
  float per_radian;  ///< [pairs of beams/rad]
  float slack;       ///< [rad] error of bearings
  float round;       ///< [pairs of beams] in a full turn
  std::int32_t hit;  ///< log-odds update: see maps::LogOddsUpdate
  std::int32_t miss;
  std::int32_t limit;
  std::uint32_t spare3;
  StripTable flat_strips;
  StripTable steep_strips;
};

/// The line of a beam.
struct BeamLine {
  float slope;  ///< rows per column or, for steep lines, columns per row, in [-1, 1]
  float reach;  ///< [cells] signed length along the line, offset by SF_STEEP_REACH for steep lines; 0: only the
                ///< sensor's cell
};

/// Eight words of one map, or eight strips: two words.
struct MapBlock {
  std::uint32_t row;    ///< MapRow
  std::uint32_t place;  ///< low 16 bits: first column (of words, or of cells) or first row; high 16 bits: row of words,
                        ///< or chunk
};

}  // namespace sf::sensors

#endif
#endif
