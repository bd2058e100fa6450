#pragma once
// Recorded occupancy maps.

#include <string>
#include <vector>

#include "apps/options/options.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::apps {

/// Draws the last map of every robot that recorded one: a single `map.png`, merged if there are several, or one
/// `map_NAME.png` each if they cannot be merged.
/// @return the files written.
std::vector<std::string> draw_maps(const record::Recording& recording, const world::World& world,
                                   const PlotOptions& options, const std::string& folder);

}  // namespace sf::apps
