#pragma once
// Fleets of any size at one density: caves of 16 m, as many as there are hundreds of robots, side by side.

#include <cstdint>

#include "world/world.h"

namespace sf::bench {

inline constexpr std::uint32_t kRobotsPerTile = 100;

/// Every tile is closed. Robots are discs that see each other, the same hundred places in each tile, turned.
world::World tiled_cave(std::uint32_t robots, const world::Laser& laser);

/// Adds what 10 000 robots of a testbed measure beside ranges: paint and magnets in every tile, and on every robot a
/// lane edge sensor of 61 rays and an array of five magnetometers.
void add_lanes_and_magnets(world::World& world);

}  // namespace sf::bench
