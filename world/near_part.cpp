#include "world/near_part.h"

#include <algorithm>
#include <span>
#include <vector>

#include "world/wall_tree.h"

namespace sf::world {

namespace {

/// The end of the line of connected walls of one model that begins at `first`.
std::size_t end_of_line(const std::vector<Segment>& walls, std::size_t first) {
  std::size_t end = first + 1;
  while (end < walls.size() && walls[end].model == walls[first].model && walls[end].a == walls[end - 1].b) ++end;
  return end;
}

double longest_of(std::span<const Segment> walls) {
  double longest = 0.0;
  for (const Segment& wall : walls) longest = std::max(longest, glm::length(wall.b - wall.a));
  return longest;
}

}  // namespace

void keep_near(World& world, const base::Box& box, double reach) {
  const base::Box near{box.min - reach, box.max + reach};
  // Error bounds depend on the longest wall.
  double missing = longest_of(world.walls);
  std::size_t kept = 0;
  for (std::size_t first = 0, end = 0; first < world.walls.size(); first = end) {
    end = end_of_line(world.walls, first);
    const auto line = std::span(world.walls).subspan(first, end - first);
    // The rest of an outline in several pieces is not known here.
    const bool open = line.front().solid_left && line.front().a != line.back().b;
    const double longest = longest_of(line);
    if (!open && !base::meet(near, box_of(line)) && longest < missing) continue;
    if (longest == missing) missing = HUGE_VAL;
    for (const Segment& wall : line) world.walls[kept++] = wall;
  }
  world.walls.resize(kept);
  world.walls.shrink_to_fit();
}

}  // namespace sf::world
