#pragma once
// The question that lane edge sensors are asked: one road network, robots on its lanes, one fan each.

#include <cstdint>
#include <vector>

#include "world/world.h"

namespace sf::bench {

/// A fleet on a road whose robots are seen by nobody: what all methods can do.
struct LaneScene {
  world::World world;                           ///< stripes, and a mover with one lane edge sensor per robot
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot; round k is asked at turns k, k + n, ...
};

/// Streets of 0.5 m lanes, `blocks` x `blocks` of 4 m: solid edges, a dashed middle (0.15 m painted, 0.15 m not), turns
/// of 0.68 m radius between them. `robots` stand anywhere on lanes, within 20 degrees of their direction, and shift by
/// a few millimetres from round to round.
/// @param resolution [m] of the raster that paint is seen in; 0: exactly
LaneScene make_lane_scene(std::uint32_t blocks, std::uint32_t robots, double resolution);

}  // namespace sf::bench
