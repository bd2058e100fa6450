#pragma once
// Scene of the lane edge comparison: a road network, and robots on its lanes with one sensor each.

#include <cstdint>
#include <vector>

#include "world/world.h"

namespace sf::bench {

/// A fleet on a road. Robots are invisible to each other, since not all methods support visible ones.
struct LaneScene {
  world::World world;                           ///< markings, and a mover with one lane edge sensor per robot
  std::vector<std::vector<base::Pose>> rounds;  ///< X_WM per round and robot; round k is used in turns k, k + n, ...
};

/// Creates streets with lanes of 0.5 m, `blocks` x `blocks` of 4 m: solid edges, a dashed centre line (0.15 m painted,
/// 0.15 m gap), and turns of 0.68 m radius. `robots` are placed at random on lanes, within 20 degrees of the lane's
/// direction, and shift by a few millimetres from round to round.
/// @param resolution [m] of the raster of the markings; 0: exact markings
LaneScene make_lane_scene(std::uint32_t blocks, std::uint32_t robots, double resolution);

}  // namespace sf::bench
