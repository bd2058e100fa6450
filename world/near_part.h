#pragma once
// The part of a world round a place, for processes that sense only there.

#include "base/box.h"
#include "world/world.h"

namespace sf::world {

/// Drops walls that are farther than `reach` [m] from the box, outline by outline: inside it, rays up to that length,
/// solids, models, error bounds and contacts are those of the whole world. All other tables, extent and hash stay. Of
/// files that are not read yet, their near walls alone ever come into memory.
void keep_near(World& world, const base::Box& box, double reach);

}  // namespace sf::world
