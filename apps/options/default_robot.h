#pragma once
// Loads worlds for commands. A world without a robot (a ROS map, a bare floor plan) gets a default one, so that it can
// be inspected and driven in.

#include "apps/options/options.h"
#include "scenarios/default_robot.h"

namespace sf::apps {

/// Loads the world, adds a robot if it has none, clones robots if their number is > 0, and prints its warnings.
/// @param use option name for `--robot-from` without clones
world::World load_with_robots(const WorldOptions& options, const CloneOptions& clones = {},
                              scenarios::OwnRobot use = scenarios::OwnRobot::needs_room);

/// Loads a world for its traffic lights. @throws base::InputError also if it has none
world::World load_lights(const std::string& file);

}  // namespace sf::apps
