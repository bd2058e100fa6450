#pragma once
// Starts that a seed chooses: `random_pose` and `random_present` of models.
//
// A model with one of these keys is a mover, since its copies (world/copies.h) have different places.

#include <cstdint>

#include "world/world.h"

namespace sf::world {

/// Chooses the start of a mover: its pose, uniform within the spread around `X_WM`, and whether it is in the world.
/// @param X_WM its pose in the file  @param row of the mover in its copy of the world
void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t row);

/// Chooses the starts of all movers of a world that has just been loaded.
void draw_starts(World& world, std::uint64_t seed);

}  // namespace sf::world
