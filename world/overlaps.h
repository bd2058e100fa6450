#pragma once
// Finds robots that overlap at their start poses.

#include <cstdint>
#include <vector>

#include "world/world.h"

namespace sf::world {

/// Two movers whose bodies overlap at their poses.
struct Overlap {
  std::uint32_t a = 0;  ///< row in World::movers
  std::uint32_t b = 0;  ///< row in World::movers, above `a`
  bool operator<(const Overlap& other) const { return a != other.a ? a < other.a : b < other.b; }
};

struct Overlaps {
  std::vector<std::uint32_t> robots;  ///< rows of all robots that overlap another, ascending
  std::vector<Overlap> pairs;         ///< ascending; includes each of `robots`, but not every pair of a crowd
  bool complete = true;               ///< false: the search reached its limit, and overlaps may be missing
};

/// Returns overlaps of bodies that stop robots; touching bodies do not overlap. Tags can be anywhere. The search is
/// limited to 20 million comparisons of edges.
Overlaps find_overlaps(const World& world);

}  // namespace sf::world
