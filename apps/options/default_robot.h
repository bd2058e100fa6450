#pragma once
// Worlds as commands load them. One without a robot (a ROS map, a bare floor plan) is lent one, so that it can be
// looked at and driven in.

#include "apps/options/options.h"
#include "scenarios/default_robot.h"

namespace sf::apps {

/// Loads the world, lends it a robot where it has none, clones robots when their number is > 0, and prints its
/// warnings.
/// @param use of `--robot-from` without clones
world::World load_with_robots(const WorldOptions& options, const CloneOptions& clones = {},
                              scenarios::OwnRobot use = scenarios::OwnRobot::needs_room);

/// Loads a world for its traffic lights. @throws base::InputError also where it has none
world::World load_lights(const std::string& file);

}  // namespace sf::apps
