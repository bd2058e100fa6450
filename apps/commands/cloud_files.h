#pragma once
// Point clouds of a recording's lidars, for other programs.

#include <string>
#include <vector>

#include "apps/options/recording_part.h"

namespace sf::apps {

/// Writes the folder `clouds`, a file for each reading of the chosen lidars (`ROBOT_SENSOR_000000.pcd`), and
/// `clouds.csv`, which has the times and poses of all. @return `clouds.csv`; nothing without readings of lidars
/// @throws Incomplete when a stop was requested
std::vector<std::string> write_clouds(const RecordingPart& part, const std::string& folder, CloudFormat format);

}  // namespace sf::apps
