#pragma once
// Recordings as CSV files (RFC 4180): a heading with units, then one row per sample; an empty field is unknown. Every
// number parses to the recorded value.

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "apps/options/recording_part.h"
#include "sensors/sensor_set.h"

namespace sf::apps {

/// Writes `trajectories.csv`: state and commanded twist of each chosen mover at each tick. @return the file written
std::string write_trajectories_csv(const RecordingPart& part, const std::string& folder);

/// Writes `lights.csv`: the state of each light at each tick. @return the file written
std::string write_lights_csv(const RecordingPart& part, const std::string& folder);

/// Writes one file per sensor type, such as `laser.csv`, with one row per element of each reading. @return the files
/// written
std::vector<std::string> write_readings_csv(const RecordingPart& part, const std::string& folder);

class CsvFile;

/// Writes `NAME.csv` for each derived sensor of a world, or `ROBOT_NAME.csv` for names of several robots: time and
/// columns of its readings, one row per element.
class DerivedCsv {
 public:
  DerivedCsv(const world::World& world, const sensors::SensorSet& sensor_set, const std::string& folder);
  ~DerivedCsv();
  /// @throws Incomplete when a stop was requested
  void add(const base::ReadingBlock& reading);
  /// Gives the files their names. @return the files written
  std::vector<std::string> close();

 private:
  struct Table {
    std::string path;
    std::size_t width;
    std::unique_ptr<CsvFile> file;
  };
  std::map<std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>, Table> tables_;  ///< by type, mover, sensor
};

}  // namespace sf::apps
