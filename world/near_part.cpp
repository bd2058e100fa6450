#include "world/near_part.h"

#include <algorithm>
#include <span>
#include <vector>

#include "world/outlines.h"
#include "world/wall_tree.h"

namespace sf::world {

namespace {

/// Returns whether a wall continues the line of connected walls of one model that ends with `last`.
bool goes_on(const Segment& last, const Segment& wall) { return wall.model == last.model && wall.a == last.b; }

std::size_t end_of_line(const std::vector<Segment>& walls, std::size_t first) {
  std::size_t end = first + 1;
  while (end < walls.size() && goes_on(walls[end - 1], walls[end])) ++end;
  return end;
}

double longest_of(std::span<const Segment> walls) {
  double longest = 0.0;
  for (const Segment& wall : walls) longest = std::max(longest, glm::length(wall.b - wall.a));
  return longest;
}

/// Selects lines of walls, in the world's order.
class NearLines {
 public:
  /// @param longest [m] longest wall of the world; one wall of that length is kept, since error bounds depend on it
  NearLines(const base::Box& near, double longest) : near_(near), missing_(longest) {}

  bool keeps(std::span<const Segment> line) {
    // The rest of an outline in several pieces is unknown here.
    const bool open = line.front().solid_left && line.front().a != line.back().b;
    const double longest = longest_of(line);
    if (!open && !base::meet(near_, box_of(line)) && longest < missing_) return false;
    if (longest == missing_) missing_ = HUGE_VAL;
    return true;
  }

 private:
  base::Box near_;
  double missing_;
};

void drop_far_lines(std::vector<Segment>& walls, NearLines& lines) {
  std::size_t kept = 0;
  for (std::size_t first = 0, end = 0; first < walls.size(); first = end) {
    end = end_of_line(walls, first);
    const auto line = std::span(walls).subspan(first, end - first);
    if (!lines.keeps(line)) continue;
    for (const Segment& wall : line) walls[kept++] = wall;
  }
  walls.resize(kept);
}

void read_near_lines(const OutlineFile& file, std::vector<Segment>& walls, NearLines& lines) {
  std::vector<Segment> line;
  const auto end_line = [&] {
    if (!line.empty() && lines.keeps(line)) walls.insert(walls.end(), line.begin(), line.end());
    line.clear();
  };
  read_outlines(file, [&](std::span<const Segment> more) {
    if (!line.empty() && !goes_on(line.back(), more.front())) end_line();
    line.insert(line.end(), more.begin(), more.end());
  });
  end_line();
}

}  // namespace

void keep_near(World& world, const base::Box& box, double reach) {
  double longest = longest_of(world.walls);
  for (const OutlineFile& file : world.unread) longest = std::max(longest, file.longest);
  NearLines lines({box.min - reach, box.max + reach}, longest);
  drop_far_lines(world.walls, lines);
  for (const OutlineFile& file : world.unread) read_near_lines(file, world.walls, lines);
  world.unread.clear();
  world.walls.shrink_to_fit();
}

}  // namespace sf::world
