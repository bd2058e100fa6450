#include "scenarios/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "control/explore.h"
#include "scenarios/visible_area.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/sensor_type.h"
#include "sensors/sonar.h"
#include "tests/instrumented.h"
#include "world/wall_tree.h"

namespace sf::scenarios {
namespace {

using maps::Cell;

world::World mapping_world() {
  return world::load_world(SF_SOURCE_DIR "/worlds/mapping/mapping.world", {.sensors = sensors::world_file_words()});
}

maps::GridGeometry small() { return {-0.12, 0.12, 0.03, 2, 2}; }

TEST(Coverage, CountsOnlyFreeCellsOfTheReference) {
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

/// Returns the map of the first laser of the first robot.
RobotMap map_of(const world::World& world, double cell = 0.03) {
  return RobotMap(world, sensors::laser_type.parse(world).rows.at(0), cell);
}

/// One missed cell suffices.
TEST(Coverage, IsNeverRoundedUpToAll) {
  EXPECT_EQ(coverage_text({9159, 3}), "3 of 9159") << "missed, not seen";
  EXPECT_EQ(coverage_text({9159, 0}), "0 of 9159");
}

/// Other cells would be offset from the explorer's by part of a cell, and could be unknown in its map.
TEST(Coverage, UsesTheCellsOfTheExplorer) {
  const world::World world = mapping_world();
  EXPECT_EQ(map_of(world).grid().geometry, control::grid_around(world));
}

TEST(Coverage, ReadingsOfOtherRobotsAreIgnored) {
  const world::World world = mapping_world();
  RobotMap map = map_of(world);
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

/// Rounding of a line may free a cell whose centre is inside a wall; such cells are not required.
TEST(Coverage, CellsInsideObstaclesAreNotRequired) {
  const world::World world = mapping_world();
  const RobotMap map = map_of(world);
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
  const RobotMap map = map_of(world);
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

/// Tests every cell from every position against every wall, with independent code.
struct BruteForce {
  const world::World& world;
  maps::GridGeometry grid;
  sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
  std::vector<base::Pose> eyes = {};

  bool is_free(glm::dvec2 a, glm::dvec2 b) const {
    const auto side = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) { return base::cross(q - p, r - p) > 0.0; };
    return std::none_of(world.walls.begin(), world.walls.end(), [&](const world::Segment& w) {
      return side(a, b, w.a) != side(a, b, w.b) && side(w.a, w.b, a) != side(w.a, w.b, b);
    });
  }
  bool is_clear(glm::dvec2 p) const {
    return std::none_of(world.walls.begin(), world.walls.end(),
                        [&](const world::Segment& w) { return world::distance(p, w.a, w.b) < world.movers[0].radius; });
  }
  void collect_eyes() {
    maps::OccupancyGrid known(grid);
    const base::Pose& X_WM = world.movers[0].X_WM;
    std::vector<maps::CellAt> open{maps::cell_at(grid, {X_WM.x, X_WM.y})};
    while (!open.empty()) {
      const maps::CellAt at = open.back();
      open.pop_back();
      const glm::dvec2 p = maps::middle(grid, at);
      if (!maps::contains(grid, at) || known.at(at) != Cell::unexplored || !is_clear(p)) continue;
      known.set(at, Cell::free);
      for (int h = 0; h < 16; ++h) {
        const base::Pose X_WS = base::compose({p.x, p.y, 0.0, h * M_PI / 8.0}, laser.X_MS);
        if (is_free(p, {X_WS.x, X_WS.y})) eyes.push_back(X_WS);
      }
      for (int k = 0; k < 4; ++k) open.push_back({at.column + (k - 1) % 2, at.row + (2 - k) % 2});
    }
  }
  bool sees(glm::dvec2 p) const {
    return std::any_of(eyes.begin(), eyes.end(), [&](const base::Pose& X_WS) {
      const glm::dvec2 d = base::rotate(-X_WS.yaw, p - glm::dvec2{X_WS.x, X_WS.y});
      return glm::length(d) < laser.range_max && std::abs(std::atan2(d.y, d.x)) <= 0.5 * laser.fov &&
             is_free({X_WS.x, X_WS.y}, p);
    });
  }
  bool has_wall(glm::dvec2 p) const {  // within the circle around the cell
    return std::any_of(world.walls.begin(), world.walls.end(),
                       [&](const world::Segment& w) { return world::distance(p, w.a, w.b) < 0.71 * grid.cell; });
  }
};

/// Rooms with random, crossing walls; the grid is offset so that no centre is on the edge of a line of sight.
TEST(Coverage, TheVisibleAreaEqualsThatOfAllRays) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> at(-1.45, 1.45), length(-0.7, 0.7);
  struct Case {
    int walls;
    double range, fov, ahead;  // [m], [rad], [m]
  };
  for (const Case& c : {Case{0, 8.0, M_PI, 0.0}, Case{25, 8.0, M_PI, 0.07}, Case{40, 0.5, 0.9, 0.05},
                        Case{40, 1.1, 0.2, 0.0}, Case{60, 8.0, 4.5, -0.06}}) {
    if (instrumented() && c.walls != 25) continue;
    world::World world = mapping_world();
    const glm::dvec2 start{world.movers[0].X_WM.x, world.movers[0].X_WM.y};
    std::erase_if(world.walls, [](const world::Segment& wall) { return wall.z_min > 0.0; });  // above the beams
    for (int i = 0; i < c.walls; ++i) {
      const glm::dvec2 a{at(random), at(random)}, b = a + glm::dvec2{length(random), length(random)};
      if (world::distance(start, a, b) > 0.3) world.walls.push_back({.a = a, .b = b, .z_max = 0.5});
    }
    world::update_extent_and_hash(world);
    world.movers[0].radius = 0.09;  // reaches every place
    sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
    laser.range_max = c.range, laser.fov = c.fov, laser.X_MS.x = c.ahead;
    world.movers[0].sensors = {sensors::laser_sensor(laser)};
    BruteForce all{world, {-1.8123, 1.8456, 0.0811, 12, 12}};
    all.collect_eyes();
    ASSERT_GT(all.eyes.size(), 100u);
    const maps::OccupancyGrid seen = visible_area(world, 0, all.grid);
    int free = 0;
    for (std::int64_t row = 0; row < maps::rows(all.grid); ++row)
      for (std::int64_t column = 0; column < maps::columns(all.grid); ++column) {
        const glm::dvec2 p = maps::middle(all.grid, {column, row});
        const Cell cell = seen.at({column, row});
        if (all.has_wall(p)) continue;
        EXPECT_EQ(cell == Cell::free, all.sees(p)) << c.walls << " walls: " << p.x << " " << p.y;
        EXPECT_NE(cell, Cell::occupied);
        free += cell == Cell::free;
      }
    EXPECT_GT(free, 100);
  }
}

/// Behind a cell with a wall there may be visible cells again, through a gap next to it.
TEST(Coverage, LightPassesThroughGaps) {
  world::World world = mapping_world();
  for (const auto& [from, to] : {std::pair{-1.5, 0.0}, {0.05, 1.5}})
    world.walls.push_back({.a = {from, 0.35}, .b = {to, 0.35}, .z_max = 0.5});
  world::update_extent_and_hash(world);
  const RobotMap map = map_of(world);
  const maps::OccupancyGrid seen = visible_area(world, 0, map.grid().geometry);
  int beyond = 0;
  for (int i = 0; i < 30; ++i) beyond += seen.at(maps::cell_at(seen.geometry, {0.025, 0.5 + 0.03 * i})) == Cell::free;
  EXPECT_GT(beyond, 10) << "as far as the laser reaches";
}

/// Larger cells bound the work; all of the world is covered.
TEST(Coverage, LargeWorldsHaveLargeCells) {
  world::World world = mapping_world();
  world.walls.push_back({.a = {-900.0, -500.0}, .b = {900.0, 500.0}, .z_max = 0.5});
  world::update_extent_and_hash(world);
  const maps::GridGeometry grid = map_of(world).grid().geometry;
  EXPECT_LE(maps::words(grid), 1u << 18);
  EXPECT_GT(maps::words(grid), 1u << 17);
  EXPECT_TRUE(maps::is_valid(grid));
  EXPECT_GE(static_cast<double>(maps::columns(grid)) * grid.cell, 1800.0);
  EXPECT_GE(static_cast<double>(maps::rows(grid)) * grid.cell, 1000.0);
}

/// Searched once: robots of one shape whose positions are connected see the same area.
TEST(Coverage, EqualRobotsShareTheirReference) {
  world::World world = mapping_world();
  world.movers[0].X_WM.y = -1.0;  // clear of the wall
  world.movers.resize(3, world.movers[0]);
  world.movers[1].X_WM.x += 0.1;
  world.movers[2].radius += 0.02;
  const sensors::SensorSet sensor_set(world);
  VisibleArea area(world, sensor_set);
  const maps::GridGeometry grid = map_of(world, 0.1).grid().geometry;
  const maps::OccupancyGrid& first = area.of(0, grid);
  EXPECT_EQ(&area.of(1, grid), &first);
  EXPECT_EQ(first.words, visible_area(world, 1, grid).words);
  EXPECT_NE(&area.of(2, grid), &first) << "it does not fit where the others do";
}

/// No cell behind a closed wall is visible.
TEST(Coverage, StopsAtWalls) {
  world::World world = mapping_world();
  const glm::dvec2 from{-1.5, 0.0}, to{1.5, 0.0};
  world::Segment wall{.a = from, .b = to, .z_max = 0.5, .solid_left = false};
  world.walls.push_back(wall);
  world::update_extent_and_hash(world);
  const RobotMap map = map_of(world);
  const maps::OccupancyGrid seen = visible_area(world, 0, map.grid().geometry);
  for (std::int64_t column = 0; column < maps::columns(seen.geometry); ++column) {
    const maps::CellAt north = maps::cell_at(seen.geometry, {maps::middle(seen.geometry, {column, 0}).x, 0.2});
    EXPECT_NE(seen.at(north), Cell::free) << column;
  }
}

}  // namespace
}  // namespace sf::scenarios
