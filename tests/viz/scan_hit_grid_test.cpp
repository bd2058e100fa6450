#include "viz/scan_hit_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/viz/scenes.h"

namespace sf::viz {
namespace {

using base::Pose;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kBehind = 0.01;  // cells, as stated in scan_hit_grid.h

/// One beam along +x from the middle of cell (0, 2) of a 10 x 5 grid of 1 m cells.
ScanHitGrid one_beam(double range, double range_max, double range_min = 0.0) {
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  grid.add_scan({0.5, 2.5, 0, 0}, {&range, 1}, 0.0, 0.0, range_max, range_min);
  return grid;
}

int known_cells(const ScanHitGrid& grid) {
  int known = 0;
  for (int j = 0; j < grid.rows(); ++j)
    for (int i = 0; i < grid.columns(); ++i) known += grid.state(i, j) == CellState::unexplored ? 0 : 1;
  return known;
}

TEST(Occupancy, StartsUnexplored) {
  const ScanHitGrid grid({0, 0, 2, 1}, 0.5);
  EXPECT_EQ(grid.columns(), 4);
  EXPECT_EQ(grid.rows(), 2);
  EXPECT_EQ(known_cells(grid), 0);
}

TEST(Occupancy, LastColumnMayReachBeyond) {  // 1.2 m in cells of 0.5 m: three, and 1.5 m of them
  const ScanHitGrid grid({1, 2, 2.2, 3}, 0.5);
  EXPECT_EQ(grid.columns(), 3);
  EXPECT_DOUBLE_EQ(grid.extent().x_max, 2.5);
}

TEST(Occupancy, WholeCellsAreNotOneMore) {  // 3 m / 0.03 m is 100.00000000000001 in floating point
  EXPECT_EQ(ScanHitGrid({0, 0, 3, 3}, 0.03).columns(), 100);
}

TEST(Occupancy, EndIsOccupiedPathIsFree) {
  const ScanHitGrid grid = one_beam(4.2, 8.0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(grid.state(i, 2), CellState::free) << i;
  EXPECT_EQ(grid.state(4, 2), CellState::occupied);
  EXPECT_EQ(grid.state(5, 2), CellState::unexplored);
  EXPECT_EQ(known_cells(grid), 5);
}

TEST(Occupancy, RangeMaxMarksNothing) {  // no echo: the cell at the end is free as well
  const ScanHitGrid grid = one_beam(4.2, 4.2);
  EXPECT_EQ(grid.state(4, 2), CellState::free);
  EXPECT_EQ(known_cells(grid), 5);
}

TEST(Occupancy, JustUnderRangeMaxIsAnEcho) {
  EXPECT_EQ(one_beam(std::nextafter(4.2, 0.0), 4.2).state(4, 2), CellState::occupied);
}

TEST(Occupancy, InfinityFreesUpToRangeMax) { EXPECT_EQ(known_cells(one_beam(kInfinity, 4.2)), 5); }

TEST(Occupancy, RangesWithoutMeaningAreLeftOut) {
  EXPECT_EQ(known_cells(one_beam(kNaN, 8.0)), 0);
  EXPECT_EQ(known_cells(one_beam(-1.0, 8.0)), 0);
  EXPECT_EQ(known_cells(one_beam(-kInfinity, 8.0)), 0);
  EXPECT_EQ(known_cells(one_beam(0.1, 8.0, 0.1)), 0);  // range_min: ranges up to it are skipped
  EXPECT_EQ(known_cells(one_beam(0.05, 8.0, 0.1)), 0);
}

TEST(Occupancy, ZeroIsAnEchoWithoutRangeMin) {  // a sensor on a surface
  EXPECT_EQ(one_beam(0.0, 8.0).state(0, 2), CellState::occupied);
}

TEST(Occupancy, WallOnABorderLiesBehindIt) {  // from both sides, and with a rounding error of a nanometre
  for (const double error : {-1e-9, 0.0, 1e-9}) {
    EXPECT_EQ(one_beam(3.5 + error, 8.0).state(4, 2), CellState::occupied);
    ScanHitGrid back({0, 0, 10, 5}, 1.0);
    const double range = 4.5 + error;
    back.add_scan({8.5, 2.5, 0, M_PI}, {&range, 1}, 0.0, 0.0, 8.0);
    EXPECT_EQ(back.state(3, 2), CellState::occupied);
    EXPECT_EQ(back.state(4, 2), CellState::free);
  }
}

TEST(Occupancy, EchoOutsideTheGridIsNoEcho) {
  const ScanHitGrid grid = one_beam(40.0, 80.0);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(grid.state(i, 2), CellState::free);
}

TEST(Occupancy, SensorOutsideTheGrid) {  // beams that cross the grid count
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const double range = 9.7;
  grid.add_scan({-5.0, 2.5, 0, 0}, {&range, 1}, 0.0, 0.0, 80.0);
  EXPECT_EQ(grid.state(4, 2), CellState::occupied);
  EXPECT_EQ(known_cells(grid), 5);
}

TEST(Occupancy, BeamBesideTheGrid) {
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const double range = 9.7;
  grid.add_scan({-5.0, 7.0, 0, 0}, {&range, 1}, 0.0, 0.0, 80.0);
  grid.add_scan({-5.0, 2.0, 0, M_PI}, {&range, 1}, 0.0, 0.0, 80.0);
  EXPECT_EQ(known_cells(grid), 0);
}

TEST(Occupancy, OccupiedBeatsFreeWithinAScan) {  // two beams through one cell, in either order
  for (const bool echo_first : {true, false}) {
    ScanHitGrid grid({0, 0, 10, 5}, 1.0);
    std::vector<double> ranges{echo_first ? 4.2 : 8.0, echo_first ? 8.0 : 4.2};
    grid.add_scan({0.5, 2.5, 0, 0}, ranges, 0.0, 1e-6, 8.0);
    EXPECT_EQ(grid.hits(4, 2), 1u);
    EXPECT_EQ(grid.passes(4, 2), 0u);
    EXPECT_EQ(grid.passes(5, 2), 1u);
  }
}

TEST(Occupancy, ACellCountsOncePerScan) {
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const std::vector<double> ranges(50, 4.2);
  grid.add_scan({0.5, 2.5, 0, 0}, ranges, 0.0, 1e-6, 8.0);
  EXPECT_EQ(grid.hits(4, 2), 1u);
  EXPECT_EQ(grid.passes(2, 2), 1u);
}

TEST(Occupancy, PassesOutvoteHits) {  // one hit: occupied up to kPassesPerHit passes, free beyond
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const double echo = 4.2;
  const double nothing = 8.0;
  grid.add_scan({0.5, 2.5, 0, 0}, {&echo, 1}, 0.0, 0.0, 8.0);
  for (std::uint32_t k = 0; k < ScanHitGrid::kPassesPerHit; ++k) {
    grid.add_scan({0.5, 2.5, 0, 0}, {&nothing, 1}, 0.0, 0.0, 8.0);
    EXPECT_EQ(grid.state(4, 2), CellState::occupied);
  }
  grid.add_scan({0.5, 2.5, 0, 0}, {&nothing, 1}, 0.0, 0.0, 8.0);
  EXPECT_EQ(grid.state(4, 2), CellState::free);
}

TEST(Occupancy, CountersDoNotOverflow) {  // beyond 65535 scans the ratio stays
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const double echo = 4.2;
  for (int k = 0; k < 70000; ++k) grid.add_scan({0.5, 2.5, 0, 0}, {&echo, 1}, 0.0, 0.0, 8.0);
  EXPECT_EQ(grid.state(4, 2), CellState::occupied);
  EXPECT_EQ(grid.state(2, 2), CellState::free);
  EXPECT_GT(grid.hits(4, 2), 30000u);
}

TEST(Occupancy, MoversLeaveNoMark) {
  ScanHitGrid grid({0, 0, 10, 5}, 1.0);
  const double echo = 4.2;
  const std::uint8_t moving = 1;
  grid.add_scan({0.5, 2.5, 0, 0}, {&echo, 1}, 0.0, 0.0, 8.0, 0.0, {&moving, 1});
  EXPECT_EQ(grid.state(3, 2), CellState::free);
  EXPECT_EQ(grid.state(4, 2), CellState::unexplored);
}

/// The length of the segment from `a` to `b` within [x, x + 1] x [y, y + 1], or less than 0 when it misses.
double length_within(glm::dvec2 a, glm::dvec2 b, double x, double y) {
  double t0 = 0.0;
  double t1 = 1.0;
  const glm::dvec2 d = b - a;
  const double from[] = {x - a.x, y - a.y};
  const double along[] = {d.x, d.y};
  for (int axis = 0; axis < 2; ++axis) {
    if (along[axis] == 0.0) {
      if (from[axis] > 0.0 || from[axis] + 1.0 < 0.0) return -1.0;
      continue;
    }
    const double u = from[axis] / along[axis];
    const double v = (from[axis] + 1.0) / along[axis];
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
  }
  return (t1 - t0) * length(d);
}

TEST(Occupancy, AgreesWithLookingAtEveryCell) {
  constexpr double cell = 0.07;
  constexpr double range_max = 1.9;
  constexpr double touch = 1e-9;  // cells; a beam that only touches a corner may count or not
  std::mt19937 draw(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 60; ++k) {
    ScanHitGrid grid({-1, -1, 2, 1}, cell);
    const Pose X_WS{-1.5 + 4 * unit(draw), -1.5 + 3 * unit(draw), 0, k % 5 ? 6.3 * unit(draw) : 0.5 * M_PI * k};
    std::vector<double> ranges;
    for (int i = 0; i < 25; ++i) ranges.push_back(std::min(range_max, 2.4 * unit(draw)));
    grid.add_scan(X_WS, ranges, -1.0, 0.08, range_max);
    for (int j = 0; j < grid.rows(); ++j) {
      for (int i = 0; i < grid.columns(); ++i) {
        bool hit = false;
        double longest = -1.0;
        for (std::size_t n = 0; n < ranges.size(); ++n) {
          const glm::dvec2 from{(X_WS.x + 1) / cell, (X_WS.y + 1) / cell};
          const bool met = ranges[n] < range_max;
          const double bearing = X_WS.yaw - 1.0 + 0.08 * static_cast<double>(n);
          const glm::dvec2 to = from + base::rotate(bearing, {ranges[n] / cell + (met ? kBehind : 0.0), 0.0});
          const double inside = length_within(from, to, i, j);
          longest = std::max(longest, inside);
          hit = hit || (met && std::floor(to.x) == i && std::floor(to.y) == j);
        }
        const CellState state = grid.state(i, j);
        if (hit) {
          EXPECT_EQ(state, CellState::occupied) << i << ", " << j << " of " << k;
        } else if (longest > touch) {
          EXPECT_EQ(state, CellState::free) << i << ", " << j << " of " << k;
        } else if (longest < -touch) {
          EXPECT_EQ(state, CellState::unexplored) << i << ", " << j << " of " << k;
        }
      }
    }
  }
}

TEST(Occupancy, SharesSumToOne) {
  const AreaShares part = shares(one_beam(4.2, 8.0));
  EXPECT_DOUBLE_EQ(part.free, 4.0 / 50.0);
  EXPECT_DOUBLE_EQ(part.occupied, 1.0 / 50.0);
  EXPECT_DOUBLE_EQ(part.unexplored, 45.0 / 50.0);
}

TEST(Occupancy, FindsTheWallsOfARoom) {
  const world::World room = scenes::make_world(6, 4, 0, 0);
  ScanHitGrid grid(room.extent, 0.05);
  for (double x = 1.0; x < 6.0; x += 1.0)
    grid.add_scan({x, 2.0, 0, 0}, scenes::scan(room, {x, 2.0, 0, 0}, 2 * M_PI, 1441, 8.0), -M_PI, 2 * M_PI / 1440, 8.0);
  const auto at = [&](double x, double y) {
    return grid.state(static_cast<int>((x + 0.5) / 0.05), static_cast<int>((y + 0.5) / 0.05));
  };
  for (double x = 0.1; x < 5.9; x += 0.1) {
    EXPECT_EQ(at(x, 4.02), CellState::occupied) << x;
    EXPECT_EQ(at(x, -0.02), CellState::occupied) << x;
    EXPECT_EQ(at(x, 2.02), CellState::free) << x;
    EXPECT_EQ(at(x, 4.3), CellState::unexplored) << x;
  }
}

}  // namespace
}  // namespace sf::viz
