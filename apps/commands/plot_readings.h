#pragma once
// Draws recorded readings over time, one figure per sensor type except maps: curves, or heat maps for sensors with many
// elements.

#include <string>
#include <vector>

#include "apps/options/options.h"
#include "record/recording.h"
#include "viz/series_figure.h"
#include "world/world.h"

namespace sf::apps {

/// Draws `lane_edge.png`, `magnetometer.png`, `gps.png` and so on into `folder`; with `csv`, also writes the curves.
/// @return the files written.
/// @throws base::InputError for an element in `options` that no recorded sensor has
std::vector<std::string> draw_readings(const record::Recording& recording, const world::World& world,
                                       const PlotOptions& options, const std::string& folder);

/// Returns the curves as a table with the columns panel, curve, time_s and value.
std::string csv_of(const viz::SeriesOptions& figure);

}  // namespace sf::apps
