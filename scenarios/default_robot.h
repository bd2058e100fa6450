#pragma once
// The robot that is lent to worlds without one (a ROS map, a bare floor plan), so that they can be looked at and driven
// in.

#include <string>

#include "world/world.h"

namespace sf::scenarios {

/// When `world` has no robot: adds `roomba1`, a Create (disc of 0.33 m) with a laser of 361 rays over 180 degrees and 8
/// m, at the origin. @return true when it did
bool add_default_robot(world::World& world);

/// Of a user's own robot, in place of the default one.
enum class OwnRobot : std::uint8_t {
  for_copies,   ///< the world's robots are replaced by its copies
  needs_room,   ///< a world with robots is an error
  where_needed  ///< a world with robots keeps these
};

/// Adds the robot that a world is lent: `from`, "FILE:NAME" of a world file (world::append_robot_of) that is found as
/// worlds are; the default one where that is empty and the world has no robot.
/// @return the name of the robot that was added; empty: none
/// @throws base::InputError as append_robot_of does, and for a world with robots as `use` states
std::string lend_robot(world::World& world, const std::string& from, OwnRobot use, const world::LoadOptions& options);

}  // namespace sf::scenarios
