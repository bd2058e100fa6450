#pragma once
// The default robot, added to worlds without one (a ROS map, a bare floor plan) for viewing and driving.

#include <string>

#include "world/world.h"

namespace sf::scenarios {

/// If `world` has no robot, adds `roomba1` at the origin: a Create (disc of 0.33 m) with a laser of 361 rays over 180
/// degrees and 8 m.
/// @return true if it was added
bool add_default_robot(world::World& world);

/// How to use a user's own robot in place of the default one.
enum class OwnRobot : std::uint8_t {
  for_copies,   ///< its copies replace the world's robots
  needs_room,   ///< a world with robots is an error
  where_needed  ///< a world with robots keeps them
};

/// Adds a robot to a world: `from`, "FILE:NAME" of a world file (world::append_robot_of) that is searched as worlds
/// are, or the default robot if `from` is empty and the world has no robot.
/// @return the name of the added robot; empty: none
/// @throws base::InputError as append_robot_of, and for a world with robots as given by `use`
std::string lend_robot(world::World& world, const std::string& from, OwnRobot use, const world::LoadOptions& options);

}  // namespace sf::scenarios
