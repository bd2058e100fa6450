#pragma once
// Recorded readings over time, one figure per sensor type that has any, but for maps: curves, or heat maps of sensors
// with many elements.

#include <string>
#include <vector>

#include "apps/options/options.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::apps {

/// Draws `lane_edge.png`, `magnetometer.png`, `gps.png` and so on into `folder`; with `csv` the curves, too.
/// @return the files written.
/// @throws base::InputError for an element of `options` that no recorded sensor has
std::vector<std::string> draw_readings(const record::Recording& recording, const world::World& world,
                                       const PlotOptions& options, const std::string& folder);

}  // namespace sf::apps
