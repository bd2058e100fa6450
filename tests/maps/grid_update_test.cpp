// Tests the update rule of maps against cells computed by hand and against an independent definition of lines.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "maps/grid_update.h"
#include "maps/map_text.h"
#include "tests/sensors/chance.h"

namespace sf::maps {
namespace {

/// 12 x 12 cells of 1 m, the first at the origin.
GridGeometry geometry() { return {0.0, 12.0, 1.0, 3, 3}; }

/// One beam along +x of the sensor's frame.
OccupancyGrid one_beam(const base::Pose& X_WS, double range, double range_max, double range_min = 0.0) {
  OccupancyGrid grid(geometry());
  const std::vector<glm::dvec2> beams = beam_directions(0.0, 1);
  const std::vector<double> ranges{range};
  add_scan(grid, {X_WS, ranges, beams, range_min, range_max});
  return grid;
}

TEST(MapRule, HitOccupiesItsEnd) {
  const OccupancyGrid grid = one_beam({2.5, 9.5, 0, 0}, 3.0, 8.0);
  EXPECT_EQ(grid_text(grid).substr(2 * 13, 12), "00   1000000");
  EXPECT_EQ(count(grid).occupied, 1u);
  EXPECT_EQ(count(grid).free, 3u);
}

TEST(MapRule, MissFreesItsEnd) {
  for (const double range : {3.0, 100.0, std::numeric_limits<double>::infinity()})
    EXPECT_EQ(grid_text(one_beam({2.5, 9.5, 0, 0}, range, 3.0)).substr(2 * 13, 12), "00    000000") << range;
}

TEST(MapRule, InvalidRangesChangeNoCell) {
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, 0}, std::nan(""), 3.0)).unexplored, 144u);
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, 0}, -0.1, 3.0)).unexplored, 144u);
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, 0}, 0.5, 3.0, 0.5)).unexplored, 144u) << "that, or anything nearer";
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, 0}, 0.0, 3.0, 0.5)).unexplored, 144u);
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, 0}, 0.51, 3.0, 0.5)).occupied, 1u);
}

TEST(MapRule, ZeroRangeOccupiesTheSensorsCell) {
  const OccupancyGrid grid = one_beam({2.5, 9.5, 0, 0}, 0.0, 3.0);
  EXPECT_EQ(grid.at({2, 2}), Cell::occupied);
  EXPECT_EQ(count(grid).unexplored, 143u);
}

TEST(MapRule, OccupiedTakesPrecedenceWithinAScan) {
  // The end of the first beam lies on the second's line; setting the beams in turn would overwrite it.
  OccupancyGrid grid(geometry());
  const std::vector<glm::dvec2> beams{{1, 0}, {1, 0}};
  const std::vector<double> ranges{3.0, 5.0};
  add_scan(grid, {{2.5, 9.5, 0, 0}, ranges, beams, 0.0, 8.0});
  EXPECT_EQ(grid_text(grid).substr(2 * 13, 12), "00   1 10000");
}

TEST(MapRule, LaterScanOverwrites) {
  OccupancyGrid grid = one_beam({2.5, 9.5, 0, 0}, 3.0, 8.0);
  const std::vector<glm::dvec2> beams{{1, 0}};
  const std::vector<double> ranges{6.0};
  add_scan(grid, {{2.5, 9.5, 0, 0}, ranges, beams, 0.0, 8.0});
  EXPECT_EQ(grid_text(grid).substr(2 * 13, 12), "00      1000");
  const std::vector<double> nearer{4.0};
  add_scan(grid, {{2.5, 9.5, 0, 0}, nearer, beams, 0.0, 8.0});
  EXPECT_EQ(grid_text(grid).substr(2 * 13, 12), "00    1 1000")
      << "a free cell is occupied; cells behind it are unchanged";
}

TEST(MapRule, SensorOutsideTheMap) {
  const OccupancyGrid into = one_beam({-2.5, 9.5, 0, 0}, 4.0, 8.0);
  EXPECT_EQ(grid_text(into).substr(2 * 13, 12), " 10000000000") << "from outside";
  const OccupancyGrid out = one_beam({9.5, 9.5, 0, 0}, 7.0, 8.0);
  EXPECT_EQ(grid_text(out).substr(2 * 13, 12), "000000000   ") << "its end is outside";
  EXPECT_EQ(count(out).unexplored, 141u) << "and enters no other row";
  EXPECT_EQ(count(one_beam({-5.5, 9.5, 0, 0}, 4.0, 8.0)).unexplored, 144u);
  for (const double far : {1e9, 1e300, std::numeric_limits<double>::infinity(), std::nan("")})
    EXPECT_EQ(count(one_beam({far, 9.5, 0, 0}, 4.0, 8.0)).unexplored, 144u) << far;
  EXPECT_EQ(count(one_beam({2.5, 9.5, 0, std::nan("")}, 4.0, 8.0)).unexplored, 144u);
}

TEST(MapRule, SameCellsFarFromTheOrigin) {
  // 2^17 m away, positions in multiples of 1/64 m: sums are exact, so the map must be equal.
  trial::Chance chance(3);
  const std::vector<glm::dvec2> beams = beam_directions(M_PI, 91);
  for (int k = 0; k < 50; ++k) {
    const base::Pose X{chance.below(12 * 64) / 64.0, chance.below(12 * 64) / 64.0, 0, chance.between(-4, 4)};
    std::vector<double> ranges;
    for (int i = 0; i < 91; ++i) ranges.push_back(chance.below(6 * 64) / 64.0);
    const double far = 131072.0;
    OccupancyGrid here(geometry());
    OccupancyGrid there(GridGeometry{far, 12.0 - far, 1.0, 3, 3});
    add_scan(here, {X, ranges, beams, 0.0, 5.0});
    add_scan(there, {{X.x + far, X.y - far, 0, X.yaw}, ranges, beams, 0.0, 5.0});
    // An end within rounding of a boundary could fall to either side; none of these ends does.
    EXPECT_EQ(here.words, there.words);
  }
}

/// The cells of one line by the definition of the rule: the nearest cell to the point at step i of n.
TEST(MapRule, LinesFollowTheRule) {
  trial::Chance chance(4);
  for (int k = 0; k < 3000; ++k) {
    const auto dc = static_cast<std::int32_t>(chance.below(41)) - 20;
    const auto dr = static_cast<std::int32_t>(chance.below(41)) - 20;
    GridGeometry wide{0, 0, 1, 11, 11};
    OccupancyGrid grid(wide);
    TracedScan scan;
    scan.sensor = {21, 21};
    scan.box = cells_of(wide);
    const std::uint32_t end[] = {pack_end(dc, dr, false)};
    add_traced_scan(grid, scan, end);
    OccupancyGrid expected(wide);
    const bool flat = std::abs(dc) >= std::abs(dr);
    const int n = std::max(std::abs(dc), std::abs(dr));
    for (int i = 0; i <= n; ++i) {
      const long double t = n > 0 ? static_cast<long double>(i) / n : 0.0L;
      const auto aside = static_cast<std::int64_t>(std::round(t * (flat ? dr : dc)));  // halves away from zero
      const std::int64_t along = i * ((flat ? dc : dr) < 0 ? -1 : 1);
      expected.set({21 + (flat ? along : aside), 21 + (flat ? aside : along)}, Cell::free);
    }
    ASSERT_EQ(grid.words, expected.words) << dc << " " << dr;
  }
}

TEST(MapRule, PackedEndsKeepTheirSigns) {
  for (const int c : {-1023, -1, 0, 1, 1023})
    for (const int r : {-1023, -7, 0, 7, 1023})
      for (const bool hit : {false, true}) {
        const std::uint32_t end = pack_end(c, r, hit);
        EXPECT_EQ(columns_of(end), c);
        EXPECT_EQ(rows_of(end), r);
        EXPECT_EQ(hit_of(end), hit);
      }
}

TEST(MapRule, BearingsAreExactAtTheFieldOfView) {
  const auto beams = beam_directions(M_PI, 5);
  EXPECT_EQ(beams[0].y, -beams[4].y) << "mirrored";
  EXPECT_EQ(beams[2].x, 1.0) << "the middle one looks ahead";
  EXPECT_EQ(beam_directions(M_PI, 1)[0].x, 1.0);
}

TEST(LogOdds, EachScanCountsOnceAndClamps) {
  LogOddsGrid grid(geometry(), {85, 40, 200});
  // Two beams through the same cells count as one miss per cell.
  const std::vector<glm::dvec2> beams{{1, 0}, {1, 0}};
  const std::vector<double> ranges{3.0, 3.0};
  const auto add = [&](double range) {
    const std::vector<double> both{range, range};
    add_scan(grid, {{2.5, 9.5, 0, 0}, both, beams, 0.0, 8.0});
  };
  const auto at = [&](std::int64_t column) {
    const OccupancyGrid shape(geometry());
    return grid.cells[16 * shape.word_of({column, 2}) + OccupancyGrid::shift_of({column, 2}) / 2];
  };
  add(3.0);
  EXPECT_EQ(at(5), 85);
  EXPECT_EQ(at(4), -40);
  EXPECT_EQ(at(6), 0);
  for (int k = 0; k < 9; ++k) add(3.0);
  EXPECT_EQ(at(5), 200);
  EXPECT_EQ(at(4), -200);
  EXPECT_EQ(to_occupancy(grid).at({5, 2}), Cell::occupied);
  add(6.0);
  EXPECT_EQ(to_occupancy(grid).at({5, 2}), Cell::occupied) << "one miss is not enough";
  for (int k = 0; k < 5; ++k) add(6.0);
  EXPECT_EQ(at(5), -40);
  EXPECT_EQ(to_occupancy(grid).at({5, 2}), Cell::free);
  EXPECT_EQ(to_occupancy(grid).at({9, 9}), Cell::unexplored);
}

}  // namespace
}  // namespace sf::maps
