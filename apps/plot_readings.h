#pragma once
// Recorded readings over time, one figure per type of sensor that has one.

#include <string>
#include <vector>

#include "record/recording.h"

namespace sf::apps {

/// Draws `lane_edge.png` and `magnetometer.png` into `folder`, where the recording holds such readings.
/// @return the files written.
std::vector<std::string> draw_readings(const record::Recording& recording, const std::string& folder);

}  // namespace sf::apps
