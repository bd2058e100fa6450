#pragma once
// The transformation between a commanded twist and the wheels.

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

/// The twist that the mover's actuator model (key `command_law`) makes of `command`. NaN and infinity become 0.
/// - direct: the command itself.
/// - player_create: an iRobot Create under Player's driver. The driver sends a speed in whole mm/s, at most 500 mm/s,
///   and a radius in whole millimetres: half of the commanded one and at most 2 m. A turn command is therefore about
///   doubled, and any turn is at least |forward| / 2 m. Without a turn the robot drives straight; without a forward
///   speed it spins in place, with wheel speeds of `track` / 2 times the turn, in whole mm/s.
/// A pure function. `limit_kinematics` applies the limits of the drive
/// (maximum speeds: world::Mover::max_forward).
base::Twist apply_actuator_model(const world::Mover& mover, const base::Twist& command);

}  // namespace sf::robots
