#pragma once
// Starts that a seed chooses: `random_pose`, `random_present` and `random_size` of models, and the variations of
// robots: `random_slip`, `random_acceleration` and `random_noise`.
//
//   draw_starts(world, seed);      // poses, presence and sizes
//   clone_robots(world, ...);
//   draw_variations(world, seed);  // of all robots, clones included
//
// A model with one of the first three keys is a mover, since its copies (world/copies.h) have different places. All
// draws are uniform, and depend only on the seed and the mover's number among the movers of its kind that have a key.

#include <cstdint>
#include <span>
#include <vector>

#include "world/world.h"

namespace sf::world {

/// A mover as loaded, from which the movers of runs are made.
struct Original {
  Mover mover;
  glm::dvec3 size;  ///< size_of
};
/// Returns those of a world without copies, by row.
std::vector<Original> originals_of(const World& world);

/// Chooses the start of a mover: its pose, uniform within the spread around `X_WM`, and whether it is in the world.
/// @param X_WM its pose in the file  @param number key of its random numbers
void draw_start(Mover& mover, const Pose& X_WM, std::uint64_t seed, std::uint32_t number);
/// Returns a size [m] within the spread around `size`, that of the file.
glm::dvec3 draw_size(const RandomStart& random, const glm::dvec3& size, std::uint64_t seed, std::uint32_t number);
Variation draw_variation(const RandomStart& random, std::uint64_t seed, std::uint32_t number);

/// Gives a mover a size (world/shapes.h). The size of its model, which copies of a world share, follows in one world.
void set_size(World& world, std::uint32_t mover, const Original& original, const glm::dvec3& size);

/// Chooses poses and presence of the movers of one copy of a world. Those of objects do not depend on the number of
/// robots. @param first row of its first mover  @param robots false: robots start as loaded, before others place them
void draw_poses(World& world, std::uint32_t first, std::span<const Original> originals, std::uint64_t seed,
                bool robots = true);
/// Returns sizes [m] by row.
std::vector<glm::dvec3> draw_sizes(std::span<const Original> originals, std::uint64_t seed);
/// Chooses poses, presence and sizes of a world that has just been loaded. Updates its extent and hash.
void draw_starts(World& world, std::uint64_t seed, bool robots = true);

/// Chooses the variations of `count` movers of one copy of a world.
void draw_variations(World& world, std::uint32_t first, std::size_t count, std::uint64_t seed);
/// The same for a world without copies. Updates its hash if it has any.
void draw_variations(World& world, std::uint64_t seed);

}  // namespace sf::world
