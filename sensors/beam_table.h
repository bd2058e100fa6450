#pragma once
// Tables of beam directions, for patterns that are not rings: CSV with a heading, one beam per line in the order of the
// scan. Columns, in any order: `azimuth_deg`, `elevation_deg` or `zenith_deg`, and optionally `time_s`; also as in the
// tables that Livox publishes: `Time/s,Azimuth/deg,Zenith/deg`. Others are ignored.

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "world/world.h"

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

/// Returns the file that a sensor's setting `directions` names. @throws base::InputError, at the setting, if it is
/// missing
std::string beam_table_path(const world::Sensor& sensor, const world::Setting& directions);
/// Start of the option of recordings that has the hash of a table, before the file's name.
inline constexpr std::string_view kBeamTableOption = "directions ";
/// Returns the files of a world's lidars, each once, with hashes of their contents. @throws base::InputError
std::map<std::string, std::uint64_t> beam_table_hashes(const world::World& world);

/// @throws base::InputError with file and line
BeamTable read_beam_table(const std::string& file);
/// @param file for errors
BeamTable parse_beam_table(const std::string& file, std::string_view text);

}  // namespace sf::sensors
