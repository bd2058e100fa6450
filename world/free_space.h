#pragma once
// Free poses for a fleet.
//
// A pose is free if the robot's circle plus a margin touches no wall, tag, earlier pose or border of a map's known
// area, and if the pose is reachable. A flood fill on a coarse grid, starting at the robot's own pose, marks the
// reachable region. Poses are therefore never in a solid, outside the building, in unknown space, or in a room whose
// doors are too narrow. If the robot's own pose is not free, the largest free region enclosed by walls is used.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/pose.h"
#include "world/ground.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::world {

/// [m] Smallest distance between a placed robot's circle and anything else.
inline constexpr double kPlaceMargin = 0.05;

struct Disc {
  glm::dvec2 p;
  double radius = 0.0;  ///< [m]
};

/// The region of one robot. Walls that neither stop robots nor are visible are ignored. The searched area contains the
/// walls and 10 m around the robot, but at most 2000 circle diameters along each axis.
class FreeSpace {
 public:
  FreeSpace(const World& world, const Mover& robot);
  FreeSpace(FreeSpace&&) noexcept;
  FreeSpace& operator=(FreeSpace&&) noexcept;
  ~FreeSpace();

  /// Returns `count` poses for robots like that one, as high above the ground of `world`, uniformly distributed over
  /// its region, with any yaw in (-pi, pi). Pose k depends on (seed, k), the world and poses 0..k-1, but not on
  /// `count`.
  /// @param world that of the constructor, or a copy  @param tags places that they avoid
  /// @throws base::InputError if there is not enough room
  std::vector<Pose> poses(const World& world, std::uint32_t count, std::uint64_t seed,
                          std::span<const Disc> tags) const;

 private:
  struct Area;
  std::unique_ptr<const Area> area_;
};

/// Returns the circles of the tags among `movers` that are in the world.
std::vector<Disc> places_of_tags(std::span<const Mover> movers);

/// Returns FreeSpace(world, robot).poses(world, count, seed, places_of_tags(world.movers)).
std::vector<Pose> free_poses(const World& world, const Mover& robot, std::uint32_t count, std::uint64_t seed);

/// Returns the row of the robot to copy: the robot with that name; without a name, the first robot with sensors, or
/// else the first robot. Tags are not robots.
/// @throws base::InputError if there is no robot, or none with that name
std::uint32_t robot_to_copy(const World& world, const std::string& name = "");

/// Same as clone_robots in world/world.h, with copies of the robot named `of`; empty: robot_to_copy(world).
void clone_robots(World& world, std::uint32_t count, std::uint64_t seed, const std::string& of);

/// Checks places for robots in a world, which must outlive it.
class PlaceCheck {
 public:
  explicit PlaceCheck(const World& world);

  /// Returns why the robot cannot be at that pose, such as "within a wall": in or on a wall that stops it, outside the
  /// floor plan, or in unknown space. Empty: the pose is possible.
  std::string problem(const Mover& robot, const Pose& X_WM) const;
  /// Returns a user message if the robot cannot be at its start pose, else an empty string. Tags can be anywhere.
  std::string start_problem(const Mover& robot) const;

 private:
  const World& world_;
  Ground ground_;
  WallTree walls_;              ///< walls that stop robots
  std::vector<Segment> known_;  ///< border of a map's known area; empty: everything is known
  const Model* plan_;           ///< the floor plan; null: none
};

}  // namespace sf::world
