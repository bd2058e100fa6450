#pragma once
// Worlds as commands load them. One without a robot (a ROS map, a bare floor plan) is lent one, so that it can be
// looked at and driven in.

#include "world/world.h"

namespace sf::apps {

/// Loads the world, lends it a robot where it has none, clones robots when `count` > 0, and tells of its warnings.
world::World load_with_robots(const std::string& file, const world::LoadOptions& options, std::uint32_t count = 0,
                              std::uint64_t seed = 1, const std::string& of = "");

/// Loads a world for its traffic lights. @throws base::InputError also where it has none
world::World load_lights(const std::string& file);

}  // namespace sf::apps
