#pragma once
// Recordings as CSV files (RFC 4180): a heading with units, then one row per sample; an empty field is unknown. Every
// number parses to the recorded value.

#include <string>
#include <vector>

#include "apps/options/recording_part.h"

namespace sf::apps {

/// Writes `trajectories.csv`: state and commanded twist of each chosen mover at each tick. @return the file written
std::string write_trajectories_csv(const RecordingPart& part, const std::string& folder);

/// Writes `lights.csv`: the state of each light at each tick. @return the file written
std::string write_lights_csv(const RecordingPart& part, const std::string& folder);

/// Writes one file per sensor type, such as `laser.csv`, with one row per element of each reading. @return the files
/// written
std::vector<std::string> write_readings_csv(const RecordingPart& part, const std::string& folder);

}  // namespace sf::apps
