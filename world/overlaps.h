#pragma once
// Robots that overlap where they start.

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
  std::vector<std::uint32_t> robots;  ///< rows of all that overlap another, ascending
  std::vector<Overlap> pairs;         ///< ascending; with each of `robots`, but not every pair of a crowd
  bool complete = true;               ///< false: the work was limited, and some may be missing
};

/// Overlaps of bodies that stop robots; touching ones do not overlap. Tags can stand anywhere. The work is limited to
/// 20 million comparisons of edges.
Overlaps find_overlaps(const World& world);

}  // namespace sf::world
