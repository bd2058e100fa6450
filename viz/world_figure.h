#pragma once
// The loaded world, seen from above.

#include <string>

#include "viz/picture_file.h"
#include "world/world.h"

namespace sf::viz {

/// Draws walls, movers with their headings and the fields of view of their lasers, at the loaded poses. Names movers if
/// there are at most twenty.
/// @param world with an up-to-date `extent` (see world::update_extent_and_hash)
/// @throws base::InputError naming the path if it cannot be written.
void draw_world(const world::World& world, const std::string& path, const Page& page = {});

}  // namespace sf::viz
