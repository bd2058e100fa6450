#pragma once
// Input of all casters: the same walls, robots and beams.

#include <cstdint>
#include <string>
#include <vector>

#include "sensors/laser_settings.h"
#include "world/world.h"

namespace sf::bench {

/// Scans of a fleet. Robots are invisible to each other, since not all casters support visible ones.
struct Scans {
  std::string scene;
  world::World world;                           ///< movers carry `laser` and have no bodies
  sensors::LaserSettings laser;                 ///< of every robot
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot; round k is used in turns k, k + n, ...
  std::vector<glm::dvec2> beams;                ///< unit vectors in the sensor's frame, from -fov/2 to +fov/2

  std::size_t robots() const { return world.movers.size(); }
  std::size_t rays() const { return robots() * beams.size(); }  ///< per round
  base::Pose X_WS(std::size_t round, std::size_t robot) const {
    return base::compose(rounds[round][robot], laser.X_MS);
  }
};

/// Places `count` robots at random free positions in `world`, whose own movers are removed. The robots turn and shift
/// by a few millimetres from round to round, so that results cannot be reused.
Scans make_scans(const std::string& scene, world::World world, std::uint32_t count,
                 const sensors::LaserSettings& laser);

/// Returns the cave of the demo and the tests, `worlds/cave.world`, without its robot.
world::World load_cave();

}  // namespace sf::bench
