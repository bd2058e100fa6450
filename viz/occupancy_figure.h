#pragma once
// A map built from scans in the greys of ROS's map_server: unknown 205, occupied black, free white. Alternatively in
// the colours of Vernier's thesis (Virtual Sensor System, 2010, figure 44): unknown dark grey, occupied blue, free
// white.

#include <string>

#include "maps/grid.h"
#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::viz {

/// @throws base::InputError naming the path if it cannot be written.
void draw_occupancy(const world::World& world, const maps::OccupancyGrid& grid, const std::string& path,
                    const Page& page = {});

}  // namespace sf::viz
