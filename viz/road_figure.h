#pragma once
// A road network seen from above: lanes with their paint, where one stops, parks and goes on.

#include <string>

#include "world/roads/network.h"

namespace sf::viz {

/// Draws lanes, paint (at least as wide as can be seen), driving directions, exits, stop lines, zones, spots,
/// checkpoints with their ids and the names of segments and zones; texts that find no room are left out. The picture is
/// as large as its lanes need, up to 4000 pixels.
/// @throws base::InputError naming the path when it cannot be written.
void draw_roads(const world::RoadNetwork& network, const std::string& png_path);

}  // namespace sf::viz
