#pragma once
// A road network seen from above: lanes with their markings, stop lines, parking spots and exits.

#include <string>

#include "viz/picture_file.h"
#include "world/roads/network.h"

namespace sf::viz {

/// Draws lanes, lane markings (at least as wide as is visible), driving directions, exits, stop lines, zones, spots,
/// checkpoints with their ids and the names of segments and zones. Texts without room are omitted. The picture size
/// follows from the lane width, up to 4000 pixels.
/// @throws base::InputError naming the path if it cannot be written.
void draw_roads(const world::RoadNetwork& network, const std::string& path, const Page& page = {});

}  // namespace sf::viz
