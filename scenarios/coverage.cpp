#include "scenarios/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/marked_values.h"
#include "control/explore.h"
#include "maps/grid_update.h"
#include "sensors/laser.h"

namespace sf::scenarios {

namespace {

using maps::Cell;

constexpr double kMostWords = 1 << 18;  ///< 61 m x 61 m in cells of 3 cm; bounds memory and time

/// Uses the explorer's grid if possible, so that both maps have the same cells.
maps::GridGeometry plan_over(const world::World& world, double cell) {
  try {
    return control::grid_around(world, cell);
  } catch (const base::InputError&) {
  }
  const world::Extent& e = world.extent;
  const double wide = e.x_max - e.x_min, high = e.y_max - e.y_min;
  const auto words = [&](double size) { return std::max(1.0, std::ceil(size / (4.0 * cell))); };
  while (words(wide) * words(high) > kMostWords || std::max(words(wide), words(high)) > maps::kMaxWordColumns)
    cell *= 1.01;
  return {e.x_min, e.y_max, cell, static_cast<std::uint32_t>(words(wide)), static_cast<std::uint32_t>(words(high))};
}

}  // namespace

RobotMap::RobotMap(const world::World& world, const sensors::SensorSpec& laser, double cell)
    : mover_(laser.mover),
      laser_(laser.sensor),
      grid_(plan_over(world, cell)),
      beams_(maps::beam_directions(laser.fov, laser.elements)),
      range_min_(laser.range_min),
      range_max_(laser.limit) {}

void RobotMap::add(const base::ReadingBlock& reading) {
  if (reading.mover != mover_ || reading.type != sensors::kLaser || reading.sensor != laser_) return;
  if (reading.values.size() != beams_.size()) return;
  maps::add_scan(grid_, {reading.X_WS, base::marked_values(reading, ranges_), beams_, range_min_, range_max_});
}

void add_scans(std::span<const base::ReadingBlock> readings, std::map<std::uint32_t, RobotMap>& maps) {
  if (maps.empty()) return;
  for (const base::ReadingBlock& reading : readings)
    if (const auto at = maps.find(reading.mover); at != maps.end()) at->second.add(reading);
}

Coverage coverage_of(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference) {
  SF_CHECK(map.geometry == reference.geometry, "maps of two geometries cannot be compared");
  Coverage seen;
  for (std::int64_t row = 0; row < maps::rows(map.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(map.geometry); ++column) {
      if (reference.at({column, row}) != Cell::free) continue;
      ++seen.wanted;
      seen.missed += map.at({column, row}) == Cell::unexplored;
    }
  return seen;
}

std::string coverage_text(const Coverage& seen) { return fmt::format("{} of {}", seen.missed, seen.wanted); }

double disagreement(const maps::OccupancyGrid& map, const maps::OccupancyGrid& reference) {
  SF_CHECK(map.geometry == reference.geometry, "maps of two geometries cannot be compared");
  std::size_t both = 0, apart = 0;
  for (std::int64_t row = 0; row < maps::rows(map.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(map.geometry); ++column) {
      const Cell a = map.at({column, row}), b = reference.at({column, row});
      if (a == Cell::unexplored || b == Cell::unexplored) continue;
      ++both;
      apart += a != b;
    }
  return both == 0 ? 0.0 : static_cast<double>(apart) / static_cast<double>(both);
}

}  // namespace sf::scenarios
