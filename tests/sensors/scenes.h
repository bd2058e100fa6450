#pragma once
// Hand-made worlds, shared by tests and benchmarks.

#include <cstdint>

#include "sensors/laser_settings.h"
#include "world/world.h"

namespace sf::scenes {

/// Returns a closed, cave-like bitmap of n x n cells, `size` [m] on a side, centred on the origin: merged boundary
/// runs, no movers.
world::World cave(std::uint32_t n, double size, std::uint64_t seed);

/// Returns a closed square of `size` [m] with `count` boxes at any angle, some of them overlapping.
world::World boxes(std::uint32_t count, double size, std::uint64_t seed);

/// Returns a laser like the SICK LMS-200 in its 361-ray mode.
sensors::LaserSettings laser(std::uint32_t samples = 361, double fov = M_PI, double range_max = 8.0);

/// Adds a robot: a 16-sided disc of 0.165 m radius with `laser`. @return its row
std::uint32_t add_robot(world::World& world, const base::Pose& pose, const sensors::LaserSettings& laser);

/// Adds `count` such robots at free positions, at least half a metre apart if there is room.
void add_robots(world::World& world, std::uint32_t count, const sensors::LaserSettings& laser, std::uint64_t seed);

/// Adds a square ring of walls around `centre`, `size` [m] on the inside: an outline around a hole.
void add_room(world::World& world, glm::dvec2 centre, double size);

/// Adds a closed outline, solid on the left of its edges.
void add_outline(world::World& world, const std::vector<glm::dvec2>& corners, const std::string& name);

}  // namespace sf::scenes
