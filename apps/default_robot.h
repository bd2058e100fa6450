#pragma once
// Worlds as commands load them. One without a robot (a ROS map, a bare floor plan) is lent one, so that it can be
// looked at and driven in.

#include "world/world.h"

namespace sf::apps {

/// When `world` has no robot: adds `roomba1`, a Create (disc of 0.33 m) with a laser of 361 rays over 180 degrees and 8
/// m, at the origin, and says so in a warning. @return true when it did.
bool add_default_robot(world::World& world);

/// Loads the world, lends it a robot where it has none, clones robots when `count` > 0, and tells of its warnings.
world::World load_with_robots(const std::string& file, const world::LoadOptions& options, std::uint32_t count = 0,
                              std::uint64_t seed = 1, const std::string& of = "");

/// Loads a world for its traffic lights. @throws base::InputError also where it has none
world::World load_lights(const std::string& file);

}  // namespace sf::apps
