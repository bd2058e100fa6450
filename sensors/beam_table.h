#pragma once
// Tables of beam directions, for patterns that are not rings: CSV with a heading, one beam per line in the order of the
// scan. Columns, in any order: `azimuth_deg`, `elevation_deg` or `zenith_deg`, and optionally `time_s`; also as in the
// tables that Livox publishes: `Time/s,Azimuth/deg,Zenith/deg`. Others are ignored.

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace sf::sensors {

struct BeamTable {
  struct Row {
    double azimuth = 0.0, elevation = 0.0;  ///< [rad] in the sensor's frame
    double time = 0.0;                      ///< [s] in [0, 3600]
  };
  std::vector<Row> rows;  ///< at least one
  bool timed = false;     ///< has the column of times

  /// Returns the latest time [s].
  double duration() const { return std::ranges::max(rows, {}, &Row::time).time; }
};

/// @throws base::InputError with file and line
BeamTable read_beam_table(const std::string& file);
/// @param file for errors
BeamTable parse_beam_table(const std::string& file, std::string_view text);

}  // namespace sf::sensors
