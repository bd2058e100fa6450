#pragma once
// Named shapes that objects can take on at run time.

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds a top-level `shape( )` to the world's shapes.
/// @throws base::InputError without a name, for a name that is taken, for more than kMostShapes, and for an outline
/// without sides or with more than kMostShapeSides
void add_shape(BuildState& b, const Entity& entity);

}  // namespace sf::world
