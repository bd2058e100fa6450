#pragma once
// Free poses for a fleet.
//
// A pose is free when the robot's circle, a margin wider, meets no wall, tag, earlier pose or border of what a map
// knows, and when the robot could have gone there: its region is flooded on a coarse grid from where it stands. So
// nothing is put into a solid, outside the building, into unknown space, or into a room without a door wide enough.
// Where the robot itself stands in no free place, the largest free region is taken that walls enclose.

#include <cstdint>
#include <string>
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

/// The row of the robot that copies are made of: the one of that name, else the first with sensors, else the first.
/// Tags are no robots.
/// @throws base::InputError when there is none, or none of that name.
std::uint32_t robot_to_copy(const World& world, const std::string& name = "");

/// As clone_robots in world/world.h, of the robot of that name; empty: of robot_to_copy(world).
void clone_robots(World& world, std::uint32_t count, std::uint64_t seed, const std::string& of);

/// Where the robot would be with that pose if it should not be there, such as "within a wall": in or on a wall that
/// stops it, outside of the floor plan, in unknown space; empty: nothing speaks against it.
std::string placement_problem(const World& world, const Mover& robot, const Pose& X_WM);

}  // namespace sf::world
