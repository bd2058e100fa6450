#pragma once
// Copies of one robot in place of a world's own.

#include "scenarios/scenario.h"

namespace sf::scenarios {

/// Puts the scenario's crowd into its world. Drawn from the scenario's seed alone.
/// - free: `world::clone_robots` of the robot.
/// - lanes: robots that plans name stay; copies stand on the lanes of the world's road network, along them, far enough
///   from each other and from those that stay for each to turn in place.
/// @throws base::InputError at the scenario's line when there is no such robot, no road network, or no room.
void spawn_fleet(const Scenario& scenario, world::World& world);

}  // namespace sf::scenarios
