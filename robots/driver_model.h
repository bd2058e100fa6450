#pragma once
// What stands between a commanded twist and the wheels.

#include "base/pose.h"
#include "world/world.h"

namespace sf::robots {

/// The twist that the mover's driver makes of `command`. Numbers that are not finite become 0.
/// - direct: the command itself.
/// - player_create: what an iRobot Create does under Player's driver, which tells it a speed in whole mm/s, at most
///   0.5 m/s, and a radius in whole millimetres, half of the one that was asked for and at most 2 m. A turn command is
///   therefore about doubled, and any turn is at least |forward| / 2 m. Without a turn it drives straight; without a
///   forward speed it spins in place, its wheels at `track` / 2 times the turn, in whole mm/s.
/// Pure: what the drive can follow is `limit_kinematics`'s business.
base::Twist apply_driver(const world::Mover& mover, const base::Twist& command);

}  // namespace sf::robots
