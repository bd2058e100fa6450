#include "scenarios/coverage.h"

#include <gtest/gtest.h>

#include "control/explore.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/sensor_type.h"
#include "sensors/sonar.h"

namespace sf::scenarios {
namespace {

using maps::Cell;

world::World mapping_world() {
  return world::load_world(SF_SOURCE_DIR "/worlds/mapping/mapping.world", {.sensors = sensors::world_file_words()});
}

maps::GridGeometry small() { return {-0.12, 0.12, 0.03, 2, 2}; }

TEST(Coverage, CountsOnlyWhatTheReferenceHasFree) {
  maps::OccupancyGrid reference(small()), map(small());
  EXPECT_EQ(coverage_of(map, reference).coverage(), 1.0);
  for (int i = 0; i < 4; ++i) reference.set({i, 0}, Cell::free);
  reference.set({4, 0}, Cell::occupied);
  EXPECT_EQ(coverage_of(map, reference).coverage(), 0.0);
  map.set({0, 0}, Cell::free);
  map.set({1, 0}, Cell::occupied);
  map.set({4, 0}, Cell::occupied);
  map.set({7, 7}, Cell::free);
  EXPECT_EQ(coverage_of(map, reference).missed, 2u);
  EXPECT_EQ(coverage_of(map, reference).wanted, 4u);
  EXPECT_EQ(coverage_of(map, reference).coverage(), 0.5);
  // Known in both: (0,0), (1,0), (4,0); one of them differs.
  EXPECT_DOUBLE_EQ(disagreement(map, reference), 1.0 / 3.0);
}

/// One missed cell suffices.
TEST(Coverage, IsNeverRoundedUpToAll) {
  EXPECT_EQ(text_of({9159, 3}), "3 of 9159") << "missed, not seen";
  EXPECT_EQ(text_of({9159, 0}), "0 of 9159");
}

/// Other cells would be offset from the explorer's by part of a cell, and could be unknown to it.
TEST(Coverage, ItsCellsAreTheExplorers) {
  const world::World world = mapping_world();
  EXPECT_EQ(RobotMap(world, 0).grid().geometry, control::grid_around(world));
}

TEST(Coverage, ReadingsOfOthersDrawNothing) {
  const world::World world = mapping_world();
  RobotMap map(world, 0);
  const sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
  const std::vector<double> ranges(laser.samples, 1.0);
  const base::ReadingBlock own{.type = sensors::kLaser, .X_WS = {0.0, 0.0, 0.1, 0.0}, .values = ranges};
  base::ReadingBlock of_another = own, of_another_type = own, of_another_laser = own, short_one = own;
  of_another.mover = 1, of_another_type.type = sensors::kSonar, of_another_laser.sensor = 1;
  short_one.values = std::span(ranges).first(ranges.size() - 1);
  for (const base::ReadingBlock& reading : {of_another, of_another_type, of_another_laser, short_one}) map.add(reading);
  const auto known = [&] {
    std::size_t count = 0;
    for (std::int64_t row = 0; row < maps::rows(map.grid().geometry); ++row)
      for (std::int64_t column = 0; column < maps::columns(map.grid().geometry); ++column)
        count += map.grid().at({column, row}) != Cell::unexplored;
    return count;
  };
  EXPECT_EQ(known(), 0u);
  map.add(own);
  EXPECT_GT(known(), 100u);
}

/// Rounding of a line may free a cell whose centre is within a wall; such cells are not required.
TEST(Coverage, CellsWithinObstaclesAreNotAskedFor) {
  const world::World world = mapping_world();
  const RobotMap map(world, 0);
  const maps::OccupancyGrid seen = visible_area(world, 0, map.grid().geometry);
  for (std::int64_t row = 0; row < maps::rows(seen.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(seen.geometry); ++column) {
      const glm::dvec2 p = maps::middle(seen.geometry, {column, row});
      const bool in_box = std::abs(p.x + 0.65) < 0.249 && std::abs(p.y - 0.75) < 0.249;
      const bool in_wall = std::max(std::abs(p.x), std::abs(p.y)) > 1.501;
      EXPECT_FALSE((in_box || in_wall) && seen.at({column, row}) == Cell::free) << p.x << " " << p.y;
    }
}

/// 3 m x 3 m without three boxes of 0.25 m^2 and the tree; no cell beyond the walls.
TEST(Coverage, TheVisibleAreaIsTheRoom) {
  const world::World world = mapping_world();
  const RobotMap map(world, 0);
  const maps::OccupancyGrid seen = visible_area(world, 0, map.grid().geometry);
  double area = 0.0;
  for (std::int64_t row = 0; row < maps::rows(seen.geometry); ++row)
    for (std::int64_t column = 0; column < maps::columns(seen.geometry); ++column) {
      if (seen.at({column, row}) != Cell::free) continue;
      const glm::dvec2 p = maps::middle(seen.geometry, {column, row});
      EXPECT_LT(std::max(std::abs(p.x), std::abs(p.y)), 1.53) << p.x << " " << p.y;
      area += seen.geometry.cell * seen.geometry.cell;
    }
  EXPECT_NEAR(area, 9.0 - 3 * 0.25 - 0.013, 0.25);
}

/// No cell behind a closed wall is visible.
TEST(Coverage, StopsAtWalls) {
  world::World world = mapping_world();
  const glm::dvec2 from{-1.5, 0.0}, to{1.5, 0.0};
  world::Segment wall{.a = from, .b = to, .z_max = 0.5, .solid_left = false};
  world.walls.push_back(wall);
  world::update_extent_and_hash(world);
  const RobotMap map(world, 0);
  const maps::OccupancyGrid seen = visible_area(world, 0, map.grid().geometry);
  for (std::int64_t column = 0; column < maps::columns(seen.geometry); ++column) {
    const maps::CellAt north = maps::cell_at(seen.geometry, {maps::middle(seen.geometry, {column, 0}).x, 0.2});
    EXPECT_NE(seen.at(north), Cell::free) << column;
  }
}

}  // namespace
}  // namespace sf::scenarios
