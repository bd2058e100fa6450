// Thermometers: the field of heat sources, noise and bias as distributions, and sources that are refused.

#include "sensors/thermometer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

TEST(Thermometer, SumsTheSourcesOverTheTemperatureOfTheWorld) {
  const world::World world = world_of(
      "temperature 20\n"
      "model( pose [1 2 0 0] heat 10 heat_radius 2 ) model( pose [-3 0 0 0] heat -8 )");
  EXPECT_DOUBLE_EQ(sensors::temperature_at(world, {1, 2}), 20.0 + 10.0 - 8.0 * std::exp(-0.5 * (16.0 + 4.0)));
  EXPECT_NEAR(sensors::temperature_at(world, {3, 2}), 20.0 + 10.0 * std::exp(-0.5), 1e-6) << "one radius away";
  EXPECT_DOUBLE_EQ(sensors::temperature_at(world, {1e6, 0}), 20.0) << "far from all";
  EXPECT_EQ(sensors::temperature_at(world_of("model( )"), {0, 0}), 0.0) << "no source";
}

TEST(Thermometer, MeasuresWhereItIsMounted) {
  const world::World world = world_of(
      "temperature 20 model( pose [1 2 0 0] heat 10 heat_radius 0.5 )\n"
      "position( pose [1 1 0 90] thermometer( pose [1 0 0 0] ) thermometer( pose [-1 0 0 0] ) )");
  EXPECT_DOUBLE_EQ(series(world, sensors::kThermometer, 1)[0][0], 30.0);
  EXPECT_NEAR(series(world, sensors::kThermometer, 1, 1, {}, 1)[0][0], 20.0 + 10.0 * std::exp(-0.5 * 16.0), 1e-9);
}

TEST(Thermometer, NoiseIsNewInEachReadingAndBiasInEachRun) {
  const world::World world = world_of("temperature 5 position( thermometer( noise 0.5 bias 2 ) )");
  double biases = 0.0, noises = 0.0;
  constexpr int kRuns = 200, kReadings = 20;
  for (int run = 0; run < kRuns; ++run) {
    const auto readings = series(world, sensors::kThermometer, kReadings, run);
    double mean = 0.0;
    for (const auto& reading : readings) mean += reading[0] / kReadings;
    biases += (mean - 5.0) * (mean - 5.0) / kRuns;
    for (const auto& reading : readings)
      noises += (reading[0] - mean) * (reading[0] - mean) / (kRuns * (kReadings - 1));
  }
  EXPECT_NEAR(biases, 4.0 + 0.25 / kReadings, 1.2) << "three standard deviations of 200 squares";
  EXPECT_NEAR(noises, 0.25, 0.02);
}

TEST(Thermometer, ImpossibleSourcesAreRefused) {
  const auto refused = [](const std::string& text) { return refusal_of([&] { world_of(text); }); };
  expect_in("trial.world:1: a heat source cannot move", refused("position( heat 1 )"));
  expect_in("'heat_radius'", refused("model( heat 1 heat_radius 0 )"));
  expect_in("'temperature'", refused("temperature -300"));
}

}  // namespace
}  // namespace sf::trial
