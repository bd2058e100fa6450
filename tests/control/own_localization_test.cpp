#include "control/own_localization.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "control/control_shell.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "tests/robots/scenes.h"

namespace sf::control {
namespace {

world::Mover localized_create(std::initializer_list<const char*> types) {
  world::World world = scenes::boxed_world(8, 8);
  world::Mover robot = scenes::add_create(world, {1, 2, 0, 0.5});
  for (const char* type : types) robot.sensors.push_back({.type = type});
  robot.track = 0.258;
  return robot;
}

constexpr std::int64_t kTenth = 100'000'000;

/// Moves straight on at 0.2 m/s from (1, 2) and 0.5 rad, with exact readings. The input's pose differs after the start.
struct Straight {
  explicit Straight(const world::Mover& mover) : localization(mover) {}

  ControllerInput step(std::span<const base::ReadingBlock> more = {}) {
    const double rolled = 0.2 * 1e-9 * static_cast<double>(time);
    const base::Pose X_WM{1 + rolled * std::cos(0.5), 2 + rolled * std::sin(0.5), 0, 0.5};
    wheels = {rolled, rolled, 1e3 * rolled, 1e3 * rolled};
    readings.assign({{.type = sensors::kEncoder, .time = time, .X_WM = X_WM, .X_WS = X_WM, .values = wheels}});
    readings.insert(readings.end(), more.begin(), more.end());
    ControllerInput input{.time = time, .readings = readings};
    input.state.X_WM = time == 0 ? X_WM : base::Pose{-50, -50, 0.1, -2};
    time += kTenth;
    return localization.localize(input);
  }

  OwnLocalization localization;
  std::int64_t time = 0;
  std::vector<double> wheels;
  std::vector<base::ReadingBlock> readings;
};

TEST(OwnLocalization, ReplacesTheStateByTheEstimate) {
  Straight robot(localized_create({"encoder"}));
  ControllerInput seen = robot.step();
  EXPECT_EQ(seen.state.X_WM.x, 1.0) << "the start is known";
  for (int k = 0; k < 50; ++k) seen = robot.step();
  EXPECT_NEAR(seen.state.X_WM.x, 1 + std::cos(0.5), 0.02);
  EXPECT_NEAR(seen.state.X_WM.y, 2 + std::sin(0.5), 0.02);
  EXPECT_NEAR(seen.state.X_WM.yaw, 0.5, 0.02);
  EXPECT_NEAR(seen.state.velocity.forward, 0.2, 0.02);
  EXPECT_EQ(seen.state.X_WM.z, 0.1) << "heights are not estimated";
  EXPECT_EQ(robot.localization.error().steps, 51u);
  EXPECT_GT(robot.localization.error().max, 50.0) << "from the poses of the inputs";
}

TEST(LocalizationError, RootMeanSquaresAndMaxima) {
  LocalizationError error;
  EXPECT_EQ(error.rms(), 0.0) << "of none";
  error.add({3.0, 4.0, 9.0, 3.1}, {0.0, 0.0, 0.0, -3.1});
  LocalizationError other;
  other.add({1.0, 1.0, 0.0, 0.25}, {1.0, 2.0, 0.0, 0.0});
  error.add(other);
  EXPECT_EQ(error.steps, 2u);
  EXPECT_DOUBLE_EQ(error.rms(), std::sqrt(0.5 * (25.0 + 1.0)));
  EXPECT_EQ(error.max, 5.0) << "heights do not count";
  EXPECT_DOUBLE_EQ(error.yaw_max, 0.25) << "3.1 and -3.1 are 0.083 apart";
}

TEST(OwnLocalization, PlacesReadingsAtTheEstimateForTheirTime) {
  Straight robot(localized_create({"encoder"}));
  for (int k = 0; k < 20; ++k) robot.step();
  // A laser that looks left from 0.1 m ahead. Its reading is half a second old, and the input's poses are at another
  // place.
  const base::Pose X_WM{7, 7, 0, 1};
  const base::Pose X_WS = base::compose(X_WM, {0.1, 0, 0.2, M_PI / 2});
  const base::ReadingBlock scan{.type = 1, .time = robot.time - 5 * kTenth, .X_WM = X_WM, .X_WS = X_WS};
  const ControllerInput seen = robot.step({&scan, 1});
  const base::ReadingBlock& placed = seen.readings.back();
  const double then = 0.2 * 1.5, now = 0.2 * 2.0;
  EXPECT_NEAR(placed.X_WM.x, 1 + then * std::cos(0.5), 0.02);
  EXPECT_NEAR(seen.state.X_WM.x, 1 + now * std::cos(0.5), 0.02);
  EXPECT_NEAR(placed.X_WS.yaw - placed.X_WM.yaw, M_PI / 2, 1e-12);
  EXPECT_NEAR(std::hypot(placed.X_WS.x - placed.X_WM.x, placed.X_WS.y - placed.X_WM.y), 0.1, 1e-12);
}

TEST(OwnLocalization, UsesEachReadingOnceAndTheAntennasPosition) {
  // The antenna is 0.3 m ahead of the robot, which is at rest, as the wheels measure.
  const base::Pose X_WM{1, 2, 0, 0.5}, X_WS = base::compose(X_WM, {0.3, 0, 0, 0});
  const std::vector<double> fix{X_WS.x, X_WS.y, 1.0}, wheels{0, 0, 0, 0};
  OwnLocalization own(localized_create({"encoder", "gps"}));
  ControllerInput seen;
  for (int k = 0; k < 100; ++k) {
    const std::int64_t time = k * kTenth;
    const base::ReadingBlock readings[] = {
        {.type = sensors::kEncoder, .time = time, .X_WM = X_WM, .X_WS = X_WM, .values = wheels},
        {.type = sensors::kGps,
         .time = time / (10 * kTenth) * (10 * kTenth),
         .X_WM = X_WM,
         .X_WS = X_WS,
         .values = fix}};
    ControllerInput input{.time = time, .readings = readings};
    input.state.X_WM = X_WM;
    seen = own.localize(input);
  }
  EXPECT_NEAR(seen.state.X_WM.x, 1.0, 0.01);
  EXPECT_NEAR(seen.state.X_WM.y, 2.0, 0.01);
  EXPECT_LT(own.error().rms(), 0.01) << "0.3 m without the antenna's place";
}

TEST(OwnLocalization, SurvivesInvalidReadings) {
  OwnLocalization own(localized_create({"encoder", "gyro", "gps"}));
  const std::vector<double> none(4, NAN), few{};
  for (std::int64_t time = -2 * kTenth; time < 20 * kTenth; time += kTenth) {
    const base::ReadingBlock readings[] = {{.type = sensors::kEncoder, .time = time, .values = none},
                                           {.type = sensors::kGyro, .time = time, .values = few},
                                           {.type = sensors::kGps, .time = time, .values = none}};
    ControllerInput input{.time = time, .readings = readings};
    input.state.X_WM = {3, 4, 0, 1};
    const base::Pose seen = own.localize(input).state.X_WM;
    EXPECT_TRUE(std::isfinite(seen.x) && std::isfinite(seen.yaw)) << time;
  }
}

TEST(OwnLocalization, IsEnabledByEncodersAndDisabledByASettingOfTheShell) {
  world::World world = scenes::boxed_world(8, 8);
  world::Mover& robot = scenes::add_create(world, {2, 2, 0, 0});
  const auto localizes = [&] {
    return localization_of(*make_controller({world}, {"wander", 0.0, {}}).controller) != nullptr;
  };
  EXPECT_FALSE(localizes()) << "a robot without sensors of its own has its true state";
  robot.sensors.push_back({.type = "gps"});
  EXPECT_FALSE(localizes()) << "a receiver alone";
  robot.sensors.push_back({.type = "encoder"});
  EXPECT_TRUE(localizes());
  for (const bool localize : {false, true}) {
    const ConfiguredController made =
        make_controller({world}, {"wander", 0.0, Settings("controller 'wander'", {{"localize", localize, ""}})});
    EXPECT_EQ(localization_of(*made.controller) != nullptr, localize);
  }
}

}  // namespace
}  // namespace sf::control
