#pragma once
// The world as viewers of recordings and bridges show it.

#include "record/run_info.h"
#include "world/world.h"

namespace sf::scenarios {

/// Walls as lines, one outline per model, where there are at most 100 000 of them; and as a map of at most 2^18 cells
/// of 5 cm or larger, within the world's extent.
record::WorldShape shape_of(const world::World& world);

/// The outline of a mover, one list of lines per colour.
std::vector<record::Outline> body_of(const world::World& world, const world::Mover& mover);

}  // namespace sf::scenarios
