#pragma once
// The part of a world around a place, for processes that sense only there.

#include "base/box.h"
#include "world/world.h"

namespace sf::world {

/// Drops walls farther than `reach` [m] from the box, whole outlines at a time. Inside the box, rays up to that length,
/// solids, models, error bounds and contacts equal those of the whole world. Keeps all other tables, the extent and the
/// hash. Of files that are not read yet, only near walls are ever held in memory.
void keep_near(World& world, const base::Box& box, double reach);

}  // namespace sf::world
