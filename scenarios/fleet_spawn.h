#pragma once
// Fleets of copies of one robot.

#include "scenarios/scenario.h"

namespace sf::scenarios {

/// Replaces robots of the world by copies as given by the scenario's FleetSpawn. Depends only on the scenario's seed.
/// - free: copies made by `world::clone_robots` replace all robots.
/// - lanes: robots named by [[robot]] entries remain. Copies are placed on lanes of the road network, in driving
///   direction, far enough from each other and from the remaining robots for each to turn in place.
/// @throws base::InputError at the scenario's line for an unknown robot, no road network, or lack of space.
void spawn_fleet(const Scenario& scenario, world::World& world);

}  // namespace sf::scenarios
