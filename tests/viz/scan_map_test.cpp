#include "viz/scan_map.h"
#include "tests/sensors/edit_laser.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sensors/laser.h"
#include "tests/viz/scenes.h"

namespace sf::viz {
namespace {

using maps::Cell;

/// A static model, a moving one, and a laser with one beam of 8 m.
world::World one_beam() {
  world::World world;
  scenes::add_model(world, "wall", 0);
  world.movers.push_back(scenes::make_robot(world, 0, {}, 0, 8.0));
  world.models[1].mover = 0;
  scenes::edit_laser(world.movers[0])->samples = 1;
  return world;
}

/// Cells of 1 m, 12 x 8.
constexpr maps::GridGeometry kPlan{0.0, 8.0, 1.0, 3, 2};

/// Adds one beam along +x from the centre of cell (0, 2). @param met row of the model that was hit
void add_beam(ScanMap& map, const world::World& world, double range, std::uint32_t met = 0) {
  const sensors::SensorSpec laser = sensors::laser_type.parse(world).rows.at(0);
  base::ReadingBlock scan;
  scan.X_WS = {0.5, 5.5, 0.0, 0.0};
  scan.values = {&range, 1};
  const std::uint32_t hit = range < laser.limit ? met : base::kNoHit;
  scan.hits = {&hit, 1};
  map.add(world, laser, {}, scan);
}

TEST(ScanMap, EndIsOccupiedAndPathIsFree) {
  ScanMap map(kPlan);
  add_beam(map, one_beam(), 3.7);
  const maps::OccupancyGrid grid = map.states();
  EXPECT_EQ(grid.at({3, 2}), Cell::free);
  EXPECT_EQ(grid.at({4, 2}), Cell::occupied);
  EXPECT_EQ(grid.at({5, 2}), Cell::unexplored);
}

TEST(ScanMap, WallOnABorderLiesBehindIt) {  // with a rounding error of a nanometre
  for (const double error : {-1e-9, 0.0, 1e-9}) {
    ScanMap map(kPlan);
    add_beam(map, one_beam(), 3.5 + error);
    EXPECT_EQ(map.states().at({3, 2}), Cell::free);
    EXPECT_EQ(map.states().at({4, 2}), Cell::occupied);
  }
}

TEST(ScanMap, EightScansOutvoteAHit) {
  const world::World world = one_beam();
  ScanMap map(kPlan);
  add_beam(map, world, 3.7);
  for (int k = 0; k < 8; ++k) add_beam(map, world, 8.0);
  EXPECT_EQ(map.states().at({4, 2}), Cell::occupied) << "eight: not yet";
  add_beam(map, world, 8.0);
  EXPECT_EQ(map.states().at({4, 2}), Cell::free);
}

TEST(ScanMap, MoversLeaveNoMark) {
  ScanMap map(kPlan);
  add_beam(map, one_beam(), 3.7, 1);
  EXPECT_EQ(map.states().at({3, 2}), Cell::free);
  EXPECT_EQ(map.states().at({4, 2}), Cell::free);
}

/// With the robot pitched down by 60 degrees, a beam of 6 m ends 3 m ahead. Hits on the floor mark free cells.
TEST(ScanMap, TiltedScansAreSeenFromAbove) {
  const world::World world = one_beam();
  for (const std::uint32_t met : {0u, base::kFloorHit}) {
    ScanMap map(kPlan);
    base::ReadingBlock scan;
    const double range = 6.4;
    scan.X_WM = {0.5, 5.5, 0.0, 0.0};
    scan.tilt.pitch = M_PI / 3;
    scan.values = {&range, 1};
    scan.hits = {&met, 1};
    map.add(world, sensors::laser_type.parse(world).rows.at(0), {}, scan);
    EXPECT_EQ(map.states().at({3, 2}), Cell::free);
    EXPECT_EQ(map.states().at({4, 2}), met == 0 ? Cell::occupied : Cell::free);
    EXPECT_EQ(map.states().at({5, 2}), Cell::unexplored);
  }
}

TEST(ScanMap, RangesUpToTheSmallestAreSkipped) {
  world::World world = one_beam();
  scenes::edit_laser(world.movers[0])->range_min = 0.1;
  ScanMap map(kPlan);
  add_beam(map, world, 0.1);
  EXPECT_EQ(map.states().at({0, 2}), Cell::unexplored);
  scenes::edit_laser(world.movers[0])->range_min = 0.0;
  add_beam(map, world, 0.0);  // a sensor on a surface: the next cell begins half a cell behind it
  EXPECT_EQ(map.states().at({1, 2}), Cell::occupied);
}

TEST(ScanMap, RangesBeyondTheMapsLimitHaveNoEcho) {  // 1022 cells
  world::World world = one_beam();
  scenes::edit_laser(world.movers[0])->range_max = 50.0;
  ScanMap map({0.0, 8.0, 0.02, 300, 40});
  EXPECT_NO_THROW(add_beam(map, world, 49.0));
  EXPECT_EQ(map.states().at({1000, 125}), Cell::free);
}

TEST(ScanMap, FindsTheWallsOfARoom) {
  world::World room = scenes::make_world(6, 4, 0, 0);
  room.movers.push_back(scenes::make_robot(room, 0, {}, 0, 8.0));
  scenes::edit_laser(room.movers[0])->fov = 2 * M_PI;
  scenes::edit_laser(room.movers[0])->samples = 1441;
  const sensors::SensorSpec laser = sensors::laser_type.parse(room).rows.at(0);
  ScanMap map(grid_over(room.extent));
  for (double x = 1.0; x < 6.0; x += 1.0) {
    const std::vector<double> ranges = scenes::scan(room, {x, 2.0, 0, 0}, laser.fov, 1441, laser.limit);
    base::ReadingBlock scan;
    scan.X_WS = {x, 2.0, 0, 0};
    scan.values = ranges;
    map.add(room, laser, {}, scan);
  }
  const maps::OccupancyGrid grid = map.states();
  const auto at = [&](double x, double y) { return grid.at(maps::cell_at(grid.geometry, {x, y})); };
  for (double x = 0.1; x < 5.9; x += 0.1) {
    EXPECT_EQ(at(x, 4.01), Cell::occupied) << x;
    EXPECT_EQ(at(x, -0.01), Cell::occupied) << x;
    EXPECT_EQ(at(x, 2.02), Cell::free) << x;
    EXPECT_EQ(at(x, 4.3), Cell::unexplored) << x;
  }
}

/// One centimetre per cell for each started 8 m, between 3 cm and 1 m, at most 4000 cells; words of 4 x 4 cells.
TEST(ScanMap, CellsGrowWithTheWorld) {
  const auto grid = [](double wide, double high) { return grid_over({1.0, 2.0, 1.0 + wide, 2.0 + high}); };
  EXPECT_EQ(grid(1.0, 1.0).cell, 0.03);
  EXPECT_EQ(grid(24.0, 1.0).cell, 0.03);
  EXPECT_EQ(grid(1.0, 24.5).cell, 0.04);
  EXPECT_EQ(grid(800.0, 1.0).cell, 1.0);
  EXPECT_EQ(grid(4000.0, 1.0).cell, 1.0);
  EXPECT_EQ(grid(1.0, 6000.0).cell, 1.5);
  const maps::GridGeometry room = grid(0.6, 4.0);
  EXPECT_EQ(room.left, 1.0);
  EXPECT_EQ(room.top, 6.0);
  EXPECT_EQ(room.word_columns, 5u) << "60 cm of 12 cm, without one for rounding";
  EXPECT_EQ(room.word_rows, 34u);
  EXPECT_EQ(grid(0.0, 0.0).word_columns, 1u);
}

TEST(ScanMap, GridsOfAllWorldsAreValid) {  // a point, a room, a continent, a strip
  for (const world::Extent& e : {world::Extent{0, 0, 0, 0}, {0, 0, 6, 4}, {-2e6, -2e6, 2e6, 2e6}, {0, 0, 1e5, 1}})
    EXPECT_TRUE(is_valid(grid_over(e))) << e.x_max;
}

}  // namespace
}  // namespace sf::viz
