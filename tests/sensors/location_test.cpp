// The derived sensor `location`: the choice among inputs that come and go, its errors, and inputs that are refused.

#include "sensors/location.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/derived/derived_sensors.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

constexpr std::size_t kX = 0, kY = 1, kValid = 2, kXX = 3, kYY = 5, kSource = 6, kAge = 7;

/// A robot with encoders, a good and a bad receiver.
world::World located(const std::string& properties, const std::string& inputs = "\"gps\" \"gps:1\" \"localization\"") {
  return world_of(
      "position( name \"r0\" pose [3 4 0 90] size [0.3 0.3 0.1] velocity_bounds [-0.5 0.5 0 0 0 0 -90 90]\n"
      "encoder() gps( noise 0.5 rate 5 ) gps( noise 4 rate 5 )\n"
      "derived( type \"localization\" inputs [\"encoder\"] )\n"
      "derived( type \"location\" inputs [" +
      inputs + "] rate 5 " + properties + " ) )");
}

farm::Fault outage(const std::string& type, std::uint32_t sensor, double from, double until) {
  return {.kind = base::FaultKind::dropout,
          .robot = "r0",
          .type = type,
          .sensor = sensor,
          .amount = 1.0,
          .from = from,
          .until = until};
}

TEST(Location, TheFirstAvailableInputIsChosen) {
  const std::vector<farm::Fault> faults{outage("gps", 0, 2.0, 6.0), outage("gps", 1, 3.0, 5.0)};
  const auto rows = series(located("max_age 0.5", "\"gps\" \"gps:1\""), sensors::kLocation, 40, 1, faults);
  const auto source = [&](double t) { return rows[static_cast<std::size_t>(std::lround(5.0 * t))][kSource]; };
  EXPECT_EQ(source(1.0), 0.0);
  EXPECT_EQ(source(2.2), 0.0) << "its last reading is fresh";
  EXPECT_EQ(source(2.6), 1.0) << "0.8 s after its last reading";
  EXPECT_TRUE(std::isnan(source(4.0))) << "none is left";
  EXPECT_EQ(rows[20][kValid], 0.0);
  EXPECT_TRUE(std::isnan(rows[20][kX]));
  EXPECT_EQ(source(5.4), 1.0) << "it returned";
  EXPECT_EQ(source(7.0), 0.0);
  EXPECT_GT(rows[12][kAge], -1e-9);
}

/// A robot that drives up to 0.5 m/s may be that far from an old fix.
TEST(Location, VarianceGrowsWithTheAgeOfAReading) {
  const auto rows = series(located("max_age 3", "\"gps\""), sensors::kLocation, 20, 1, {outage("gps", 0, 1.1, 4.0)});
  const std::vector<double>&fresh = rows[5], &old = rows[15];
  EXPECT_NEAR(fresh[kAge], 0.0, 1e-9);
  EXPECT_NEAR(old[kAge], 2.0, 1e-9);
  EXPECT_NEAR(old[kXX] - fresh[kXX], 1.0, 1e-6) << "(0.5 m/s * 2 s)^2";
  EXPECT_EQ(old[kX], fresh[kX]);
}

TEST(Location, BestIsTheInputWithTheSmallestVariance) {
  const auto rows = series(located("choose \"best\""), sensors::kLocation, 5);
  EXPECT_EQ(rows[1][kSource], 2.0) << "dead reckoning, just after a known start";
  EXPECT_NEAR(rows[1][kX], 3.0, 0.1);
}

/// Errors of weighted and intersected locations over 300 runs against what they state.
TEST(Location, StatedErrorsHold) {
  for (const char* choose : {"weighted", "intersection"}) {
    double squares = 0.0, single = 0.0;
    constexpr int kRuns = 300;
    for (int run = 0; run < kRuns; ++run) {
      const auto row = series(located(std::string("choose \"") + choose + "\"", "\"gps\" \"gps:1\""),
                              sensors::kLocation, 1, static_cast<std::uint64_t>(run))[0];
      EXPECT_EQ(row[kSource], std::string(choose) == "weighted" ? -1.0 : row[kSource]);
      squares += 0.5 * ((row[kX] - 3) * (row[kX] - 3) / row[kXX] + (row[kY] - 4) * (row[kY] - 4) / row[kYY]) / kRuns;
      single = row[kXX];
    }
    EXPECT_NEAR(squares, 1.0, 0.17) << choose << ": three standard deviations of 300 runs with two components";
    EXPECT_GT(single, 0.0);
  }
}

/// An antenna 2 m ahead of the origin: without a heading it is that far off in any direction.
TEST(Location, AntennasAreMovedToTheOriginByTheNewestHeading) {
  const std::string text =
      "position( name \"r0\" pose [3 4 0 90] encoder() gps( noise 0 rate 5 pose [2 0 0 0] )\n"
      "derived( type \"localization\" inputs [\"encoder\"] ) derived( type \"location\" rate 5 inputs [\"gps\"";
  const auto without = series(world_of(text + "] ) )"), sensors::kLocation, 3)[2];
  EXPECT_NEAR(without[kY], 6.0, 1e-6);
  EXPECT_NEAR(without[kYY], 2.0, 1e-6) << "half of 2 m squared";
  const auto with = series(world_of(text + " \"localization\"] ) )"), sensors::kLocation, 3)[2];
  EXPECT_NEAR(with[kX], 3.0, 0.1);
  EXPECT_NEAR(with[kY], 4.0, 0.1);
}

TEST(Location, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& properties, const std::string& inputs = "\"gps\"") {
    return refusal_of([&] {
      const world::World world = located(properties, inputs);
      check_derived_sensors(world, sensors::SensorSet(world));
    });
  };
  EXPECT_EQ(refused(""), "");
  expect_in("expected inputs", refused("", ""));
  expect_in("expected \"first\" or \"best\" or \"weighted\" or \"intersection\"", refused("choose \"worst\""));
  expect_in("'noise' expects at most one standard deviation", refused("noise [1 2]"));
  expect_in("'noise' expects at most one standard deviation", refused("noise [-1]"));
  expect_in("max_age", refused("max_age 0"));
  expect_in("expected gps (x_m, y_m, hdop) or pose", refused("", "\"encoder\""));
}

}  // namespace
}  // namespace sf::trial
