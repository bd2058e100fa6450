#pragma once
// Traffic lights of a world file:
//
//   light( name "light1" pose [x y z yaw] lamps 3 phases 3
//     phase[0] ["green" 8] phase[1] ["yellow" 2] phase[2] ["red" 10] offset 0 stop_lines "3.1.11 4.2.5" )

#include <vector>

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds the light described by `entity`; `model` becomes the next row of the models.
/// @throws base::InputError with file and line for a malformed plan, malformed way-points, or a light on a mover
void add_light(BuildState& b, const Entity& entity, const Model& model);

/// Returns the body of a light without blocks: a pole with a head of the full size on top. Frame as in `shape_of`.
std::vector<Segment> light_shape(const Size& size, bool single);

/// Checks, after all entities are read, that the way-points of lights exist in worlds with roads. Warns about
/// way-points without a stop line.
/// @throws base::InputError with the light's line
void check_stop_lines(BuildState& b);

}  // namespace sf::world
