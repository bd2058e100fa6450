#pragma once
// Fleets of any size at constant density: separate closed caves of 16 m, one per hundred robots.

#include <cstdint>

#include "sensors/laser_settings.h"
#include "world/world.h"

namespace sf::bench {

inline constexpr std::uint32_t kRobotsPerTile = 100;

/// Tiles are not connected. Robots are discs that see each other, at the same hundred positions in each tile, rotated.
world::World tiled_cave(std::uint32_t robots, const sensors::LaserSettings& laser);

/// Adds the other sensors of a testbed with 10 000 robots: markings and magnets in every tile, and on every robot a
/// lane edge sensor of 61 rays and an array of five magnetometers.
void add_lanes_and_magnets(world::World& world);

}  // namespace sf::bench
