#pragma once
// Recorded readings over time, one figure per sensor type that has any, but for scans and maps.

#include <string>
#include <vector>

#include "apps/options.h"
#include "record/recording.h"

namespace sf::apps {

/// Draws `lane_edge.png`, `magnetometer.png`, `gps.png` and so on into `folder`; with `csv` the curves, too.
/// @return the files written.
std::vector<std::string> draw_readings(const record::Recording& recording, const PlotOptions& options,
                                       const std::string& folder);

}  // namespace sf::apps
