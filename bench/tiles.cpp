#include "bench/tiles.h"

#include <algorithm>
#include <cmath>

#include "sensors/laser_settings.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr double kTile = 16.0;         // [m]
constexpr std::uint32_t kCells = 100;  // per side of a tile: about 1 050 walls
constexpr std::uint64_t kSeed = 3;

/// Calls `visit(shift)` for as many tiles as `robots` need.
template <class Visit>
void for_each_tile(std::size_t robots, Visit&& visit) {
  const std::size_t tiles = (robots + kRobotsPerTile - 1) / kRobotsPerTile;
  const auto across = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(tiles))));
  for (std::size_t k = 0; k < tiles; ++k)
    visit(glm::dvec2{kTile * static_cast<double>(k % across), kTile * static_cast<double>(k / across)});
}

}  // namespace

world::World tiled_cave(std::uint32_t robots, const sensors::LaserSettings& laser) {
  world::World tile = scenes::cave(kCells, kTile, kSeed);
  scenes::add_robots(tile, kRobotsPerTile, laser, 1);
  world::World world;
  world.models.push_back({"cave", "model"});
  std::uint32_t left = robots;
  for_each_tile(robots, [&](glm::dvec2 shift) {
    for (world::Segment wall : tile.walls) {
      wall.a = wall.a + shift, wall.b = wall.b + shift;
      world.walls.push_back(wall);
    }
    for (std::uint32_t k = 0; k < kRobotsPerTile && left > 0; ++k, --left) {
      const base::Pose& X = tile.movers[k].X_WM;
      scenes::add_robot(world, {X.x + shift.x, X.y + shift.y, 0.0, X.yaw + 0.1 * (shift.x + shift.y)}, laser);
    }
    world.extent.x_max = std::max(world.extent.x_max, shift.x + 0.5 * kTile);
    world.extent.y_max = std::max(world.extent.y_max, shift.y + 0.5 * kTile);
  });
  world.extent.x_min = world.extent.y_min = -0.5 * kTile;
  return world;
}

void add_lanes_and_magnets(world::World& world) {
  for_each_tile(world.movers.size(), [&](glm::dvec2 shift) {
    for (int i = -3; i <= 3; ++i) {
      const double at = 2.0 * i;
      world.lane_markings.push_back(trial::marking(shift + glm::dvec2{-7.0, at}, shift + glm::dvec2{7.0, at}, 0.03));
      world.lane_markings.push_back(trial::marking(shift + glm::dvec2{at, -7.0}, shift + glm::dvec2{at, 7.0}, 0.03));
      for (int j = -3; j <= 3; ++j)
        world.magnets.push_back(scenes::magnet(shift + glm::dvec2{at + 0.5, 2.0 * j + 0.5}));
    }
  });
  world.magnet_cutoff = 4.0;
  for (world::Mover& mover : world.movers) {
    mover.sensors.push_back(trial::edge_sensor({}));
    mover.sensors.push_back(scenes::five());
  }
}

}  // namespace sf::bench
