#pragma once
// Free poses for a fleet.
//
// A pose is free when the robot's circle plus a margin touches no wall, tag, earlier pose or border of a map's known
// area, and when the pose is reachable: a flood fill on a coarse grid from the robot's own pose marks the reachable
// region. So no pose lies in a solid, outside the building, in unknown space, or in a room whose doors are too narrow.
// When the robot's own pose is not free, the largest free region enclosed by walls is used.

#include <cstdint>
#include <string>
#include <vector>

#include "base/pose.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::world {

/// [m] smallest distance between a placed robot's circle and anything else.
inline constexpr double kPlaceMargin = 0.05;

/// `count` poses for robots like `robot`, at its height, uniform over its region, with any yaw in (-pi, pi). Pose k
/// depends on (seed, k), the world and poses 0..k-1, not on `count`. Walls that neither stop robots nor are visible are
/// ignored. The searched area contains the walls and 10 m around the robot, but at most 2000 circle diameters along
/// each axis.
/// @throws base::InputError when there is no room
std::vector<Pose> free_poses(const World& world, const Mover& robot, std::uint32_t count, std::uint64_t seed);

/// The row of the robot to copy: the robot with that name; without a name, the first robot with sensors, else the first
/// robot. Tags are not robots.
/// @throws base::InputError when there is no robot, or none with that name.
std::uint32_t robot_to_copy(const World& world, const std::string& name = "");

/// As clone_robots in world/world.h, with copies of the robot named `of`; empty: of robot_to_copy(world).
void clone_robots(World& world, std::uint32_t count, std::uint64_t seed, const std::string& of);

/// Judges places of robots in a world, which must outlive it.
class PlaceCheck {
 public:
  explicit PlaceCheck(const World& world);

  /// The reason for which the robot cannot stand at that pose, such as "within a wall": in or on a wall that stops it,
  /// outside of the floor plan, in unknown space. Empty: no objection.
  std::string problem(const Mover& robot, const Pose& X_WM) const;
  /// A message for the user where the robot cannot stand where it starts; else empty. Tags can stand anywhere.
  std::string start_problem(const Mover& robot) const;

 private:
  const World& world_;
  WallTree walls_;              ///< that stop robots
  std::vector<Segment> known_;  ///< border of a map's known area; empty: all is known
  const Model* plan_;           ///< the floor plan; null: none
};

}  // namespace sf::world
