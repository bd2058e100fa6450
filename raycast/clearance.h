#pragma once
// How close other surfaces come to each wall: what lets a 32-bit search prove that its winner is the first surface.

#include <vector>

#include "world/world.h"

namespace sf::raycast {

/// For each row of `walls`: a length [m] in [0, cap] such that nothing else comes nearer to it, except segments that
/// share an end point with it (the very same doubles) and leave it at 15 degrees or more. 0 where something crosses or
/// touches it.
std::vector<float> wall_clearances(const std::vector<world::Segment>& walls, double cap);

}  // namespace sf::raycast
