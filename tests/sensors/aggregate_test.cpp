// The derived sensor `aggregate`: one quantity from several sensors, expressions, and settings that are refused.

#include "sensors/aggregate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/derived/derived_sensors.h"
#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

constexpr std::size_t kValue = 0, kValid = 1, kVariance = 2, kSource = 3;

/// A robot at 20 degrees Celsius with two thermometers, and another at 30.
world::World measured(const std::string& properties) {
  return world_of(
      "temperature 20 model( pose [10 0 0 0] heat 10 heat_radius 0.5 )\n"
      "position( name \"r0\" gyro( noise 1 ) thermometer( noise 1 rate 5 ) thermometer( noise 2 rate 10 )\n"
      "derived( type \"localization\" inputs [\"gps\"] ) gps( noise 1 ) bumper()\n"
      "derived( type \"aggregate\" rate 10 " +
      properties + " ) )\nposition( name \"hall-1\" pose [10 0 0 0] thermometer() )");
}

std::vector<double> first_of(const std::string& properties, std::uint64_t seed = 1) {
  return series(measured(properties), sensors::kAggregate, 1, seed)[0];
}

TEST(Aggregate, WeighsUnlikeSensorsByTheirVariance) {
  const std::string both = "quantity \"temperature_C\" choose \"weighted\" inputs [\"thermometer\" \"thermometer:1\"]";
  double mean = 0.0, squares = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    const auto row = first_of(both, static_cast<std::uint64_t>(run));
    EXPECT_NEAR(row[kVariance], 0.8, 1e-6) << "1 / (1 + 1/4)";
    EXPECT_EQ(row[kSource], -1.0);
    mean += row[kValue] / kRuns;
    squares += (row[kValue] - 20.0) * (row[kValue] - 20.0) / kRuns;
  }
  EXPECT_NEAR(mean, 20.0, 3.0 * std::sqrt(0.8 / kRuns));
  EXPECT_NEAR(squares, 0.8, 3.0 * 0.8 * std::sqrt(2.0 / kRuns));
}

TEST(Aggregate, ReplacesASensorThatFails) {
  const farm::Fault outage{
      .kind = base::FaultKind::dropout, .robot = "r0", .type = "thermometer", .amount = 1.0, .from = 1.0, .until = 3.0};
  const auto rows = series(
      measured("quantity \"temperature_C\" choose \"best\" max_age 0.3 inputs [\"thermometer\" \"thermometer:1\"]"),
      sensors::kAggregate, 45, 1, {outage});
  EXPECT_EQ(rows[5][kSource], 0.0);
  EXPECT_EQ(rows[20][kSource], 1.0);
  EXPECT_NEAR(rows[20][kVariance], 4.0, 1e-6);
  EXPECT_EQ(rows[40][kSource], 0.0);
}

TEST(Aggregate, TakesSensorsOfOtherRobots) {
  EXPECT_DOUBLE_EQ(first_of("quantity \"temperature_C\" inputs [\"hall-1/thermometer\" \"thermometer\"]")[kValue], 30.0)
      << "the first as written";
  const auto row = first_of("quantity \"temperature_C\" inputs [\"hall-1/thermometer\"]");
  EXPECT_DOUBLE_EQ(row[kValue], 30.0);
  EXPECT_EQ(row[kValid], 1.0);
  EXPECT_TRUE(std::isnan(row[kVariance])) << "a thermometer without noise states none";
}

TEST(Aggregate, ComputesExpressions) {
  const auto value = [](const std::string& expression, const std::string& more = "") {
    return first_of("expression \"" + expression + "\" inputs [\"hall-1/thermometer\" \"thermometer:1\"] " + more);
  };
  EXPECT_DOUBLE_EQ(value("1.8 * hall_1.thermometer.temperature_C + 32")[kValue], 86.0);
  EXPECT_EQ(value("1.8 * hall_1.thermometer.temperature_C + 32")[kSource], 0.0);
  const auto difference = value("hall_1.thermometer.temperature_C - 3 * thermometer1.temperature_C", "noise [1 0]");
  EXPECT_NEAR(difference[kVariance], 1.0 + 9.0 * 4.0, 1e-9) << "to first order";
  EXPECT_EQ(difference[kSource], -1.0);
  EXPECT_EQ(value("hall_1.thermometer.temperature_C > 25 ? 1 : 0")[kValue], 1.0);
  EXPECT_EQ(value("1 / (hall_1.thermometer.temperature_C - 30)")[kValid], 0.0) << "a division by zero";
}

/// The variance of a derived input is the one that its covariance states for that column.
TEST(Aggregate, UsesTheCovarianceOfDerivedInputs) {
  const auto rows =
      series(measured("quantity \"y_m\" choose \"best\" inputs [\"localization\"]"), sensors::kAggregate, 3);
  EXPECT_EQ(rows[2][kValid], 1.0);
  EXPECT_NEAR(rows[2][kValue], 0.0, 0.2);
  EXPECT_GT(rows[2][kVariance], 0.0);
  EXPECT_LT(rows[2][kVariance], 0.01);
}

TEST(Aggregate, ImpossibleSettingsAreRefused) {
  const auto refused = [](const std::string& properties) {
    return refusal_of([&] {
      const world::World world = measured(properties);
      check_derived_sensors(world, sensors::SensorSet(world));
    });
  };
  const std::string input = "inputs [\"thermometer\"] ";
  expect_in("expects quantity \"COLUMN\" or expression", refused(input));
  expect_in("has a quantity or an expression",
            refused(input + "quantity \"temperature_C\" expression \"thermometer.temperature_C\""));
  expect_in("did you mean 'temperature_C'?", refused(input + "quantity \"temperatur_C\""));
  expect_in("did you mean 'thermometer.temperature_C'?", refused(input + "expression \"thermometer.temperature_\""));
  expect_in("expected '==' to compare", refused(input + "expression \"thermometer.temperature_C = 3\""));
  EXPECT_EQ(refused(input + "expression \"thermometer.temperature_C == 3 || thermometer.temperature_C >= 4\""), "");
  expect_in("uses no input", refused(input + "expression \"1 + 1\""));
  expect_in("the expression", refused(input + "expression \"thermometer.temperature_C +\""));
  expect_in("the expression", refused(input + "expression \"\""));
  expect_in("'bumper' (number 1) states none", refused("quantity \"pressed\" choose \"best\" inputs [\"bumper\"]"));
  expect_in("'gps' (number 1) states none", refused("quantity \"x_m\" choose \"best\" inputs [\"gps\"]"));
  expect_in("'thermometer:0' is listed twice",
            refused("quantity \"temperature_C\" inputs [\"thermometer\" \"thermometer:0\"]"));
  expect_in("separated by commas", refused(input + "expression \"1,8 * thermometer.temperature_C\""));
  expect_in("'choose' is for a quantity", refused(input + "choose \"best\" expression \"thermometer.temperature_C\""));
}

}  // namespace
}  // namespace sf::trial
