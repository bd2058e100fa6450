#pragma once
// The robot that is lent to worlds without one (a ROS map, a bare floor plan), so that they can be looked at and driven
// in.

#include "world/world.h"

namespace sf::scenarios {

/// When `world` has no robot: adds `roomba1`, a Create (disc of 0.33 m) with a laser of 361 rays over 180 degrees and 8
/// m, at the origin. @return true when it did
bool add_default_robot(world::World& world);

}  // namespace sf::scenarios
