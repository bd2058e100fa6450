#pragma once
// Recordings as CSV files (RFC 4180): a heading with units, then one row per sample; an empty field is not known. Every
// number reads back as the recorded one.

#include <string>
#include <vector>

#include "apps/options/recording_part.h"

namespace sf::apps {

/// `trajectories.csv`: state and commanded twist of each chosen mover at each tick. @return the file written
std::string write_trajectories_csv(const RecordingPart& part, const std::string& folder);

/// `lights.csv`: the state of each light at each tick. @return the file written
std::string write_lights_csv(const RecordingPart& part, const std::string& folder);

/// One file per sensor type, such as `laser.csv`, with a row per element of each reading. @return the files written
std::vector<std::string> write_readings_csv(const RecordingPart& part, const std::string& folder);

}  // namespace sf::apps
