#pragma once
// The world in the form shown by viewers of recordings and by bridges.

#include "record/run_info.h"
#include "world/world.h"

namespace sf::scenarios {

/// Returns walls as lines, one outline per model, if there are at most 100 000 of them; and as a map of at most 2^18
/// cells of 5 cm or larger, within the world's extent.
record::WorldShape shape_of(const world::World& world);

/// Returns the outline of a mover, one list of lines per colour.
std::vector<record::Outline> body_of(const world::World& world, const world::Mover& mover);

}  // namespace sf::scenarios
