// Inclinometers: roll and pitch of tilted robots and mounts, limits and errors.

#include "sensors/inclinometer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/refusal.h"
#include "tests/sensors/series.h"

namespace sf::trial {
namespace {

std::vector<double> sensed(const std::string& settings, const base::Tilt& tilt) {
  const world::World world = world_of("unit_angle \"radians\" position( inclinometer( " + settings + " ) )");
  farm::Farm farm(world, host_device(), {});
  const auto values = farm.sense(0, sensors::kInclinometer, 0, {5, 6, 0, 2}, tilt).values;
  return {values.begin(), values.end()};
}

void expect_tilt(const std::vector<double>& reading, double roll, double pitch, double saturated = 0.0) {
  EXPECT_NEAR(reading[0], roll, 1e-12);
  EXPECT_NEAR(reading[1], pitch, 1e-12);
  EXPECT_EQ(reading[2], saturated);
}

TEST(Inclinometer, ReadsRollAndPitch) {
  expect_tilt(sensed("", {}), 0.0, 0.0);
  expect_tilt(sensed("", {0.3, -0.2}), 0.3, -0.2);
  expect_tilt(sensed("", {-3.0, 1.5}), -3.0, 1.5);
  expect_tilt(sensed("pose6 [0 0 0 0 0.1 0]", {0.0, 0.2}), 0.0, 0.3);
  expect_tilt(sensed("pose6 [0 0 0 0 0 1.5707963267948966]", {0.3, 0.0}), 0.0, -0.3);  // turned to the left
}

TEST(Inclinometer, SaturatesAndRounds) {
  expect_tilt(sensed("range 0.25", {0.3, -0.2}), 0.25, -0.2, 1.0);
  expect_tilt(sensed("range 0.25", {-0.1, -0.3}), -0.1, -0.25, 2.0);
  expect_tilt(sensed("step 0.25", {0.3, -0.2}), 0.25, -0.25);
}

TEST(Inclinometer, ImpossibleSettingsAreRefused) {
  const std::string text = "position(\ninclinometer( range 0 ) )";
  expect_in("trial.world:2: 'range'", refusal_of([&] { sensors::SensorSet(world_of(text)); }));
}

}  // namespace
}  // namespace sf::trial
