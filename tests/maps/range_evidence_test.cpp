// Evidence of beams and cones in maps of log odds.

#include "maps/range_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sf::trial {
namespace {

using maps::RangeCone;

constexpr maps::GridGeometry kPlace{-2.0, 2.0, 0.05, 20, 20};  // 80 x 80 cells
constexpr double kMiddle = 0.025;                              // of a cell

maps::LogOddsGrid blank() { return {kPlace, {}}; }

int odds_at(const maps::LogOddsGrid& grid, glm::dvec2 p) {
  const maps::CellAt at = maps::cell_at(kPlace, p);
  const auto word = static_cast<std::size_t>(at.row / 4 * kPlace.word_columns + at.column / 4);
  return grid.cells[16 * word + static_cast<std::size_t>(4 * (at.row % 4) + at.column % 4)];
}

void add(maps::LogOddsGrid& grid, const std::vector<RangeCone>& cones) {
  maps::RangeEvidence evidence;
  evidence.trace(kPlace, cones);
  evidence.add_to(grid);
}

std::size_t above(const maps::LogOddsGrid& grid, int odds) {
  return static_cast<std::size_t>(std::ranges::count_if(grid.cells, [&](std::int16_t cell) { return cell > odds; }));
}

RangeCone cone(double half, double range, bool has_echo = true, double sigma = 0.0) {
  return {.X_WC = {kMiddle, kMiddle, 0.0, 0.0}, .half = half, .range = range, .has_echo = has_echo, .sigma = sigma};
}

TEST(RangeEvidence, BeamMarksItsEndAndFreesTheCellsBefore) {
  maps::LogOddsGrid grid = blank();
  add(grid, {cone(0.0, 1.0)});
  EXPECT_EQ(odds_at(grid, {kMiddle + 1.0, kMiddle}), maps::LogOddsUpdate{}.hit);
  EXPECT_EQ(above(grid, 0), 1u);
  for (double x = 0.0; x < 0.99; x += 0.05)
    EXPECT_EQ(odds_at(grid, {kMiddle + x, kMiddle}), -maps::LogOddsUpdate{}.miss);
  EXPECT_EQ(odds_at(grid, {kMiddle + 1.05, kMiddle}), 0);
  EXPECT_EQ(odds_at(grid, {kMiddle - 0.05, kMiddle}), 0);
  EXPECT_EQ(grid.words, maps::to_occupancy(grid).words);
}

/// Between the middles of cells, an oblique beam may end without coming near to one.
TEST(RangeEvidence, EchoMarksItsCellAtAnyBearing) {
  for (const double half : {0.0, 0.02})
    for (int k = 0; k < 2000; ++k) {
      const double bearing = 0.0031416 * k, range = 0.1 + 0.0007 * k;
      maps::LogOddsGrid grid = blank();
      add(grid, {{.X_WC = {0.013, -0.008, 0.0, bearing}, .half = half, .range = range}});
      const glm::dvec2 echo{0.013 + range * std::cos(bearing), -0.008 + range * std::sin(bearing)};
      ASSERT_GT(odds_at(grid, echo), 0) << "half " << half << ", bearing " << bearing << ", range " << range;
    }
}

TEST(RangeEvidence, ConeSharesItsEchoOverTheArc) {
  maps::LogOddsGrid narrow = blank(), wide = blank();
  add(narrow, {cone(0.12, 1.0)}), add(wide, {cone(0.3, 1.0)});
  const int at_axis = odds_at(wide, {kMiddle + 1.0, kMiddle});
  EXPECT_GT(at_axis, 0);
  EXPECT_LT(at_axis, odds_at(narrow, {kMiddle + 1.0, kMiddle})) << "a wider arc says less of each cell";
  EXPECT_LT(odds_at(narrow, {kMiddle + 1.0, kMiddle}), maps::LogOddsUpdate{}.hit);
  const glm::dvec2 aside{kMiddle + std::cos(0.2), kMiddle + std::sin(0.2)};
  EXPECT_GT(odds_at(wide, aside), 0);
  EXPECT_LT(odds_at(wide, aside), at_axis) << "the weight falls off the axis";
  EXPECT_LT(odds_at(wide, {kMiddle + 0.5, kMiddle}), odds_at(wide, {kMiddle + 0.5, kMiddle + 0.1}));
  EXPECT_LT(odds_at(wide, {kMiddle + 0.5, kMiddle + 0.1}), 0);
}

TEST(RangeEvidence, KnownCellsExplainAnEcho) {
  const glm::dvec2 wall{kMiddle + std::cos(0.15), kMiddle + std::sin(0.15)}, axis{kMiddle + 1.0, kMiddle};
  maps::LogOddsGrid unknown = blank(), known = blank();
  for (int k = 0; k < 4; ++k) add(known, {{.X_WC = {kMiddle, kMiddle, 0.0, 0.15}, .half = 0.0, .range = 1.0}});
  const int before = odds_at(known, axis);
  add(unknown, {cone(0.3, 1.0)}), add(known, {cone(0.3, 1.0)});
  EXPECT_GT(odds_at(known, wall), 0);
  EXPECT_LT(odds_at(known, axis) - before, odds_at(unknown, axis) / 2);
}

TEST(RangeEvidence, ArcOfFreeCellsMarksTheRest) {
  maps::LogOddsGrid grid = blank();
  const RangeCone echo = cone(0.3, 1.0);
  add(grid, {echo});
  const int shared = odds_at(grid, {kMiddle + 1.0, kMiddle});
  maps::LogOddsGrid freed = blank();
  for (double angle = -0.35; angle < 0.36; angle += 0.01)
    if (std::abs(angle) > 0.04)
      for (int k = 0; k < 9; ++k)
        add(freed, {{.X_WC = {kMiddle, kMiddle, 0.0, angle}, .half = 0.0, .range = 1.3, .has_echo = false}});
  const int before = odds_at(freed, {kMiddle + 1.0, kMiddle});
  add(freed, {echo});
  EXPECT_GT(odds_at(freed, {kMiddle + 1.0, kMiddle}) - before, shared);
}

TEST(RangeEvidence, NoiseWidensTheBand) {
  std::size_t cells = 0;
  for (const double sigma : {0.0, 0.03, 0.08}) {
    maps::LogOddsGrid grid = blank();
    add(grid, {cone(0.0, 1.0, true, sigma)});
    EXPECT_GT(above(grid, 0), cells) << sigma;
    cells = above(grid, 0);
  }
}

TEST(RangeEvidence, WithoutEchoTheConeIsFreeAsFarAsItSees) {
  maps::LogOddsGrid all = blank(), half = blank();
  RangeCone empty = cone(0.2, 1.0, false);
  add(all, {empty});
  empty.seen = 0.5;
  add(half, {empty});
  EXPECT_EQ(above(all, 0), 0u);
  EXPECT_EQ(odds_at(all, {kMiddle + 0.9, kMiddle}), -maps::LogOddsUpdate{}.miss);
  EXPECT_EQ(odds_at(half, {kMiddle + 0.9, kMiddle}), -maps::LogOddsUpdate{}.miss / 2);
  EXPECT_EQ(odds_at(all, {kMiddle + 1.05, kMiddle}), 0);
}

TEST(RangeEvidence, ScanCountsACellOnceAndEndsWin) {
  maps::LogOddsGrid grid = blank();
  std::vector<RangeCone> scan(5, cone(0.0, 1.0));
  scan.push_back(cone(0.0, 1.5));
  add(grid, scan);
  EXPECT_EQ(odds_at(grid, {kMiddle + 1.0, kMiddle}), maps::LogOddsUpdate{}.hit);
  EXPECT_EQ(odds_at(grid, {kMiddle + 0.5, kMiddle}), -maps::LogOddsUpdate{}.miss);
  for (int k = 0; k < 100; ++k) add(grid, scan);
  EXPECT_EQ(odds_at(grid, {kMiddle + 1.0, kMiddle}), maps::LogOddsUpdate{}.limit);
}

double normal_below(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

/// The rule of one cone in all cells of the map.
void add_plainly(maps::LogOddsGrid& grid, const RangeCone& c) {
  struct Weighed {
    std::size_t cell;
    double w, free;
  };
  std::vector<Weighed> arc, before;
  const double cell = kPlace.cell, sigma = std::max(c.sigma, 1e-6 * cell);
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const std::size_t word = i / 16, within = i % 16;
    const glm::dvec2 p =
        maps::middle(kPlace, {static_cast<std::int64_t>(4 * (word % kPlace.word_columns) + within % 4),
                              static_cast<std::int64_t>(4 * (word / kPlace.word_columns) + within / 4)});
    glm::dvec2 q = base::transform(base::inverse(c.X_WC), p);
    const glm::dvec2 echo = base::transform(c.X_WC, glm::dvec2{c.range, 0.0});
    if (c.has_echo && maps::middle(kPlace, maps::cell_at(kPlace, echo)) == p) q = {c.range, 0.0};
    const double r = std::hypot(q.x, q.y);
    if (r > c.range + cell + (c.has_echo ? 4.0 * sigma : 0.0)) continue;
    double weight = 1.0;
    if (c.half == 0.0 && (q.x < 0.0 || std::abs(q.y) > 0.5 * cell)) continue;
    if (c.half > 0.0) {
      const double share = std::abs(std::atan2(q.y, q.x)) / std::max(c.half, 0.5 * cell / std::max(r, 0.5 * cell));
      if (share >= 1.0) continue;
      weight = 1.0 - share * share;
    }
    const double beyond = normal_below((c.range - r - 0.5 * cell) / sigma);
    const double w = c.has_echo ? weight * (normal_below((c.range - r + 0.5 * cell) / sigma) - beyond) : 0.0;
    (w >= 0.05 ? arc : before).push_back({i, std::min(w, 1.0), weight * beyond * c.seen});
  }
  const auto p_of = [&](std::size_t i) { return 1.0 / (1.0 + 0.7 / 0.3 * std::exp(-grid.cells[i] / 100.0)); };
  std::vector<double> changes;
  for (const Weighed& one : arc) {
    double none = 1.0 - std::exp(-0.01 * grid.rule.hit);
    for (const Weighed& other : arc)
      if (&one != &other) none *= 1.0 - other.w * p_of(other.cell);
    changes.push_back(100.0 * std::log((1.0 - (1.0 - one.w) * none) / (1.0 - none)));
  }
  const auto change = [&](std::size_t i, double by) {
    grid.cells[i] = static_cast<std::int16_t>(
        std::clamp<int>(grid.cells[i] + static_cast<int>(std::lround(by)), -grid.rule.limit, grid.rule.limit));
  };
  for (std::size_t k = 0; k < arc.size(); ++k) change(arc[k].cell, changes[k]);
  for (const Weighed& one : before) change(one.cell, -grid.rule.miss * one.free);
}

TEST(RangeEvidence, MatchesTheRuleCellByCell) {
  std::mt19937_64 chance(7);
  const auto between = [&](double low, double high) { return std::uniform_real_distribution(low, high)(chance); };
  maps::LogOddsGrid grid = blank(), plain = blank();
  std::size_t different = 0, most = 0, gained = 0;
  for (int k = 0; k < 400; ++k) {
    const double half = k % 4 == 0 ? 0.0 : k % 4 == 1 ? between(0.01, 0.4) : between(0.4, M_PI);
    const RangeCone c{.X_WC = {between(-2.5, 2.5), between(-2.5, 2.5), 0.0, between(-7.0, 7.0)},
                      .half = half,
                      .range = between(0.0, 2.5),
                      .has_echo = k % 3 != 0,
                      .sigma = k % 5 == 0 ? 0.0 : between(0.0, 0.1),
                      .seen = between(0.2, 1.0)};
    for (std::int16_t& cell : grid.cells) cell = static_cast<std::int16_t>(between(-350.0, 350.0));
    const std::vector<std::int16_t> before = plain.cells = grid.cells;
    add(grid, {c}), add_plainly(plain, c);
    for (std::size_t i = 0; i < grid.cells.size(); ++i) {
      const auto apart = static_cast<std::size_t>(std::abs(grid.cells[i] - plain.cells[i]));
      different += apart != 0, most = std::max(most, apart), gained += grid.cells[i] > before[i];
    }
  }
  EXPECT_LE(most, 1u) << "weights are 32-bit numbers";
  EXPECT_LT(different, 200u);
  EXPECT_GT(gained, 500u);
}

TEST(RangeEvidence, ConesOutsideTheMapChangeNothing) {
  maps::LogOddsGrid grid = blank();
  for (const double x : {-10.0, 1e7, 1e300, HUGE_VAL})
    add(grid, {{.X_WC = {x, 0.0, 0.0, M_PI}, .half = 0.2, .range = 3.0}, {.X_WC = {x, 0.0, 0.0, M_PI}, .range = 3.0}});
  EXPECT_TRUE(std::ranges::all_of(grid.cells, [](std::int16_t cell) { return cell == 0; }));
}

}  // namespace
}  // namespace sf::trial
