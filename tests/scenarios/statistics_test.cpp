#include "scenarios/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "scenarios/path_report.h"
#include "scenarios/world_shape.h"

namespace sf::scenarios {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Statistics, OfNoValuesAreNaN) {
  const ErrorStatistics s = statistics_of({});
  EXPECT_EQ(s.count, 0u);
  EXPECT_TRUE(std::isnan(s.mean));
  EXPECT_TRUE(std::isnan(s.abs_most));
}

TEST(Statistics, OfOneValueHaveNoDeviation) {
  const double one[] = {-0.5};
  const ErrorStatistics s = statistics_of(one);
  EXPECT_EQ(s.mean, -0.5);
  EXPECT_EQ(s.abs_mean, 0.5);
  EXPECT_EQ(s.least, -0.5);
  EXPECT_EQ(s.abs_least, 0.5);
  EXPECT_TRUE(std::isnan(s.deviation));
}

/// A sum of three values divided by three may differ from the value by rounding.
TEST(Statistics, OfEqualValuesHaveThatMeanAndDeviationZero) {
  for (int k = 1; k <= 200; ++k) {
    const double x = 0.0123 * k;
    const double three[] = {x, x, x};
    EXPECT_EQ(statistics_of(three).mean, x);
    EXPECT_EQ(statistics_of(three).deviation, 0.0);
  }
}

TEST(Statistics, ByHand) {
  const double four[] = {1.0, -3.0, kNan, 2.0, HUGE_VAL, 4.0};
  const ErrorStatistics s = statistics_of(four);
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 1.0);
  EXPECT_DOUBLE_EQ(s.deviation, std::sqrt((0.0 + 16.0 + 1.0 + 9.0) / 3.0));
  EXPECT_EQ(s.least, -3.0);
  EXPECT_EQ(s.most, 4.0);
  EXPECT_DOUBLE_EQ(s.abs_mean, 2.5);
  EXPECT_DOUBLE_EQ(s.abs_deviation, std::sqrt((2.25 + 0.25 + 0.25 + 2.25) / 3.0));
  EXPECT_EQ(s.abs_least, 1.0);
  EXPECT_EQ(s.abs_most, 4.0);
}

/// mean^2 + variance is the same for errors and their absolute values, also in the thesis' tables.
TEST(Statistics, SquaresAgree) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<double> errors;
    for (std::uint32_t i = 0; i < 200; ++i)
      errors.push_back(0.1 + 0.3 * base::random_normal({seed, base::RandomStream::decision}, i)[0]);
    const ErrorStatistics s = statistics_of(errors);
    const double n = 200.0;
    const double plain = s.mean * s.mean + s.deviation * s.deviation * (n - 1.0) / n;
    const double size = s.abs_mean * s.abs_mean + s.abs_deviation * s.abs_deviation * (n - 1.0) / n;
    EXPECT_NEAR(plain, size, 1e-12);
    EXPECT_LE(std::abs(s.mean), s.abs_mean);
  }
}

TEST(Statistics, PercentilesAreRanks) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  EXPECT_EQ(percentile(values, 0.99), 99.0);
  EXPECT_EQ(percentile(values, 0.0), 1.0);
  EXPECT_EQ(percentile(values, 1.0), 100.0);
  EXPECT_EQ(percentile(values, 0.5), 50.0);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
  // Between ranks the next higher value.
  const double five[] = {30.0, 10.0, 50.0, 20.0, 40.0};
  for (const auto& [part, value] : {std::pair{0.2, 10.0}, {0.21, 20.0}, {0.5, 30.0}, {0.81, 50.0}, {0.99, 50.0}})
    EXPECT_EQ(percentile(five, part), value) << part;
}

TEST(Statistics, CsvHasEightColumnsPerTrial) {
  const double errors[] = {0.25, -0.75};
  const ErrorStatistics one = statistics_of(errors);
  EXPECT_EQ(csv_of(std::vector{one}),
            "trial,mean,std,min,max,abs_mean,abs_std,abs_min,abs_max\n"
            "1,-0.25,0.707106781,-0.75,0.25,0.5,0.353553391,0.25,0.75\n");
}

TEST(Thesis, TablesMatchTheThesis) {
  EXPECT_EQ(thesis_table("mapping"), nullptr);
  for (const char* name : {"lane-edge-p", "lane-edge-pi", "magnet-p", "magnet-pi"}) {
    const ThesisTable* table = thesis_table(name);
    ASSERT_NE(table, nullptr) << name;
    for (const ThesisRow& row : table->trials) {
      // The largest absolute value is one of the extremes, to the printed precision.
      EXPECT_EQ(row[7], std::max(-row[2], row[3])) << name;
      EXPECT_LE(row[0], row[4]);
    }
  }
}

/// Rows in the table's order, and "-" as the ratio to a mean of 0 in the thesis.
TEST(Statistics, TheTableHasTheRatiosOfTheMeans) {
  ThesisTable table{.experiment = "e", .number = 1, .unit = "m", .trials = {}};
  for (ThesisRow& row : table.trials) row = {0.0, 2.0, -4.0, 4.0, 0.0, 1.0, 0.5, 8.0};
  const ErrorStatistics one{.count = 2,
                            .mean = 1.0,
                            .deviation = 1.0,
                            .least = -1.0,
                            .most = 3.0,
                            .abs_mean = 0.5,
                            .abs_deviation = 0.25,
                            .abs_least = 0.5,
                            .abs_most = 2.0};
  ErrorStatistics other = one;
  other.mean = 3.0;
  const std::string text = table_of(std::vector{one, other}, table);
  EXPECT_EQ(text,
            "| [m] | mean | std | min | max | abs_mean | abs_std | abs_min | abs_max |\n"
            "|---|---|---|---|---|---|---|---|---|\n"
            "| here, trial 1 | 1.000 | 1.000 | -1.000 | 3.000 | 0.500 | 0.250 | 0.500 | 2.000 |\n"
            "| here, trial 2 | 3.000 | 1.000 | -1.000 | 3.000 | 0.500 | 0.250 | 0.500 | 2.000 |\n"
            "| thesis, trial 1 | 0.000 | 2.000 | -4.000 | 4.000 | 0.000 | 1.000 | 0.500 | 8.000 |\n"
            "| thesis, trial 2 | 0.000 | 2.000 | -4.000 | 4.000 | 0.000 | 1.000 | 0.500 | 8.000 |\n"
            "| thesis, trial 3 | 0.000 | 2.000 | -4.000 | 4.000 | 0.000 | 1.000 | 0.500 | 8.000 |\n"
            "| **here, mean** | 2.000 | 1.000 | -1.000 | 3.000 | 0.500 | 0.250 | 0.500 | 2.000 |\n"
            "| **thesis, mean** | 0.000 | 2.000 | -4.000 | 4.000 | 0.000 | 1.000 | 0.500 | 8.000 |\n"
            "| ratio | - | 0.50 | 0.25 | 0.75 | - | 0.25 | 1.00 | 0.25 |\n");
}

/// Walls are lines up to 100 000 of them, and cells of 5 cm, or larger ones for at most 2^18.
TEST(WorldShape, HasLinesAndCellsUpToTheirLimits) {
  world::World world;
  world.models.resize(1);
  world.extent = {0.0, 0.0, 12.0, 6.0};
  world.walls.resize(100'000, {.a = {1.0, 1.0}, .b = {2.0, 1.0}, .z_max = 1.0, .model = 0});
  EXPECT_FALSE(shape_of(world).walls.empty());
  EXPECT_EQ(shape_of(world).cell, 0.05);
  world.walls.push_back(world.walls.front());
  EXPECT_TRUE(shape_of(world).walls.empty());
  world.walls.resize(1);
  for (const double side : {25.0, 26.0, 1000.0}) {
    world.extent = {0.0, 0.0, side, side};
    const record::WorldShape shape = shape_of(world);
    EXPECT_LE(std::size_t{shape.columns} * shape.rows, 1u << 18) << side;
    EXPECT_GE(shape.cell, 0.05) << side;
    EXPECT_LT(shape.cell, std::max(0.05, side / 500.0) + 1e-9) << side;
    EXPECT_EQ(shape.occupied.size(), std::size_t{shape.columns} * shape.rows);
  }
}

}  // namespace
}  // namespace sf::scenarios
