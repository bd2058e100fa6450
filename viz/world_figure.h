#pragma once
// The world as it was understood, seen from above.

#include <string>

#include "world/world.h"

namespace sf::viz {

/// Draws walls, movers with their headings and the fields of view of their lasers at the poses they were loaded with.
/// Names stand beside the movers while there are at most twenty.
/// @param world needs a true `extent` (see world::update_extent_and_hash)
/// @throws base::InputError naming the path when it cannot be written.
void draw_world(const world::World& world, const std::string& png_path);

}  // namespace sf::viz
