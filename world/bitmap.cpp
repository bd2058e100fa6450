#include "world/bitmap.h"

namespace sf::world {

namespace {

// +1 at the first solid cell in the counting direction, -1 at the first free cell after a solid one, 0 elsewhere.
int step(std::uint8_t before, std::uint8_t after) { return int{after} - int{before}; }

// Appends the runs on the line between rows j - 1 and j. A solid above the line is on the left of a run to the right.
void horizontal_runs(const Bitmap& grid, std::uint32_t j, std::vector<BoundaryRun>& runs) {
  const std::vector<std::uint8_t> outside(grid.width, 0);
  const std::uint8_t* below = j > 0 ? grid.solid.data() + std::size_t{j - 1} * grid.width : outside.data();
  const std::uint8_t* above = j < grid.height ? grid.solid.data() + std::size_t{j} * grid.width : outside.data();
  int current = 0;
  std::uint32_t begin = 0;
  for (std::uint32_t i = 0; i <= grid.width; ++i) {
    const int here = i < grid.width ? step(below[i], above[i]) : 0;
    if (here == current) continue;
    if (current > 0) runs.push_back({{begin, j}, {i, j}});
    if (current < 0) runs.push_back({{i, j}, {begin, j}});
    current = here;
    begin = i;
  }
}

struct Open {
  std::int8_t side = 0;
  std::uint32_t begin = 0;
};

// Returns the runs on all vertical lines at once, row by row, in memory order of the cells. A solid to the right of the
// line is on the left of a downward run.
std::vector<std::vector<BoundaryRun>> vertical_runs(const Bitmap& grid, std::size_t most) {
  std::vector<std::vector<BoundaryRun>> runs(grid.width + 1);
  std::vector<Open> open(grid.width + 1);
  std::size_t count = 0;
  for (std::uint32_t j = 0; j <= grid.height && count <= most; ++j) {
    const std::uint8_t* row = j < grid.height ? grid.solid.data() + std::size_t{j} * grid.width : nullptr;
    std::uint8_t left = 0;
    for (std::uint32_t i = 0; i <= grid.width; ++i) {
      const std::uint8_t right = row != nullptr && i < grid.width ? row[i] : std::uint8_t{0};
      const int here = step(left, right);
      left = right;
      if (here == open[i].side) continue;
      if (open[i].side > 0) runs[i].push_back({{i, j}, {i, open[i].begin}});
      if (open[i].side < 0) runs[i].push_back({{i, open[i].begin}, {i, j}});
      if (open[i].side != 0) ++count;
      open[i] = {static_cast<std::int8_t>(here), j};
    }
  }
  return runs;
}

}  // namespace

std::vector<BoundaryRun> trace_boundary(const Bitmap& grid, std::size_t most) {
  std::vector<BoundaryRun> runs;
  for (std::uint32_t j = 0; j <= grid.height && runs.size() <= most; ++j) horizontal_runs(grid, j, runs);
  if (runs.size() > most) return runs;
  for (const auto& column : vertical_runs(grid, most - runs.size()))
    runs.insert(runs.end(), column.begin(), column.end());
  return runs;
}

glm::dvec2 corner_position(const PicturePart& part, Corner corner, double size_x, double size_y) {
  const auto fraction = [](std::uint32_t at, std::uint32_t low, std::uint32_t high) {
    return (static_cast<double>(at) - low) / (high - low) - 0.5;
  };
  return {size_x * fraction(corner.i, part.low.i, part.high.i), size_y * fraction(corner.j, part.low.j, part.high.j)};
}

}  // namespace sf::world
