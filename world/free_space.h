#pragma once
// Free poses for a fleet.
//
// A pose is free when the robot's circle, a margin wider, meets no wall, tag or earlier pose, and when the first robot
// could have gone there: its region is flooded on a coarse grid from where it stands. So nothing is put into a solid,
// outside the building, or into a room without a door wide enough. Where the robot itself stands in no free place, the
// largest free region outside solids is taken.

#include <cstdint>
#include <vector>

#include "base/pose.h"
#include "world/world.h"

namespace sf::world {

/// Kept between a placed robot's circle and anything else. [m]
inline constexpr double kPlaceMargin = 0.05;

/// `count` poses for robots like `robot`, at its height, uniform over its region, with any yaw in (-pi, pi). Pose k
/// depends on (seed, k), the world and poses 0..k-1: not on `count`. Walls that neither stop robots nor are seen are
/// left out. Reaches 10 m around the robot where the walls end sooner, and 2000 circles' widths each way at most.
/// @throws base::InputError when there is no room
std::vector<Pose> free_poses(const World& world, const Mover& robot, std::uint32_t count, std::uint64_t seed);

}  // namespace sf::world
