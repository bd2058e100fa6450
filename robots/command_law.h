#pragma once
// Command laws: how a robot's driver and firmware turn a commanded twist into wheel motion.

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

/// Returns the twist that the mover's actuator model (key `command_law`) executes for `command`. NaN and infinity
/// become 0. Pure function.
/// - direct: the command, unchanged.
/// - player_create: an iRobot Create under Player's driver. The driver sends a speed in whole mm/s, at most 500 mm/s,
///   and a radius in whole millimetres: half the commanded radius, at most 2 m. A turn command is therefore roughly
///   doubled, and every turn is at least |forward| / 2 m. Without a turn the robot drives straight. Without a forward
///   speed it spins in place with wheel speeds of `track` / 2 times the turn, in whole mm/s.
/// `limit_kinematics` applies the limits of the drive (maximum speed: world::Mover::max_forward).
base::Twist apply_actuator_model(const world::Mover& mover, const base::Twist& command);

}  // namespace sf::robots
