#pragma once
// Starts that a seed chooses: `random_pose` and `random_present` of models.
//
// A model with one of these keys is a mover, since its copies (world/copies.h) have different places.

#include <cstdint>
#include <span>

#include "world/world.h"

namespace sf::world {

/// Chooses the start of a mover: its pose, uniform within the spread around `X_WM`, and whether it is in the world.
/// @param X_WM its pose in the file  @param number key of its random numbers
void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t number);

/// Chooses the starts of the movers of one world. Those of objects do not depend on the number of robots.
/// @param X_WM their poses in the file  @param robots false: robots start at these poses, as before others replace them
void draw_starts(std::span<Mover> movers, std::span<const Pose> X_WM, std::uint64_t seed, bool robots = true);
/// The same for a world that has just been loaded. Updates its extent and hash.
void draw_starts(World& world, std::uint64_t seed, bool robots = true);

}  // namespace sf::world
