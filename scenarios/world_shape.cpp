#include "scenarios/world_shape.h"

#include <algorithm>
#include <cmath>

namespace sf::scenarios {

namespace {

/// Returns one outline per model, in order of its first segment.
std::vector<record::Outline> outlines_of(const world::World& world, const std::vector<world::Segment>& segments) {
  std::vector<record::Outline> outlines;
  std::vector<std::size_t> row_of(world.models.size(), SIZE_MAX);
  for (const world::Segment& segment : segments) {
    std::size_t& row = row_of[segment.model];
    if (row == SIZE_MAX) {
      row = outlines.size();
      outlines.push_back({world.models[segment.model].name, world.models[segment.model].color, {}});
    }
    for (const glm::dvec2& end : {segment.a, segment.b}) outlines[row].ends.emplace_back(end, segment.z_max);
  }
  return outlines;
}

/// Draws the cells along the segment, in steps of half a cell.
void draw(const world::Segment& segment, record::WorldShape& shape) {
  const glm::dvec2 along = segment.b - segment.a;
  const double steps = std::ceil(2.0 * glm::length(along) / shape.cell);
  for (double i = 0.0; i <= steps; ++i) {
    const glm::dvec2 at = (segment.a + (steps > 0.0 ? i / steps : 0.0) * along - shape.corner) / shape.cell;
    const auto column = std::min(static_cast<std::uint32_t>(std::max(0.0, at.x)), shape.columns - 1);
    const auto row = std::min(static_cast<std::uint32_t>(std::max(0.0, at.y)), shape.rows - 1);
    shape.occupied[std::size_t{row} * shape.columns + column] = true;
  }
}

void add_map(const world::World& world, record::WorldShape& shape) {
  constexpr double kLeastCell = 0.05;  // [m]
  constexpr double kMostCells = 1 << 18;
  const world::Extent& extent = world.extent;
  const glm::dvec2 size{extent.x_max - extent.x_min, extent.y_max - extent.y_min};
  if (world.walls.empty() || !(size.x > 0.0 && size.y > 0.0)) return;
  shape.cell = std::max({kLeastCell, std::sqrt(size.x * size.y / kMostCells), std::max(size.x, size.y) / kMostCells});
  shape.corner = {extent.x_min, extent.y_min};
  shape.columns = static_cast<std::uint32_t>(std::ceil(size.x / shape.cell));
  shape.rows = static_cast<std::uint32_t>(std::ceil(size.y / shape.cell));
  shape.occupied.assign(std::size_t{shape.columns} * shape.rows, false);
  for (const world::Segment& wall : world.walls) draw(wall, shape);
}

}  // namespace

record::WorldShape shape_of(const world::World& world) {
  constexpr std::size_t kMostWalls = 100'000;
  record::WorldShape shape;
  if (world.walls.size() <= kMostWalls) shape.walls = outlines_of(world, world.walls);
  add_map(world, shape);
  return shape;
}

std::vector<record::Outline> body_of(const world::World& world, const world::Mover& mover) {
  return outlines_of(world, mover.body);
}

}  // namespace sf::scenarios
