// Lane keeping and magnet keeping in closed loops: a unicycle on the thesis' path, sensors by formula.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "control/lane_keeping.h"
#include "control/magnet_keeping.h"
#include "control/stop_reason.h"
#include "robots/kinematics.h"
#include "sensors/laneedge.h"
#include "sensors/magnetometer.h"
#include "tests/control/closed_loop.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "world/path_geometry.h"

namespace sf::control {
namespace {

using base::Pose;
using base::Twist;

std::unique_ptr<Controller> make(const world::World& world, const ControllerType& type,
                                 std::vector<Setting> numbers = {}) {
  Settings settings("controller", std::move(numbers));
  return type.make({world}, settings);
}

/// One step at `X_WM` with a reading of `values`.
Twist step_with(Controller& controller, std::uint8_t type, const std::vector<double>& values, std::int64_t time = 0,
                std::uint32_t sequence = 0, const Pose& X_WM = {}) {
  const base::ReadingBlock block{.type = type, .sequence = sequence, .time = time, .values = values};
  return controller.step({.time = time, .state = {.X_WM = X_WM}, .readings = {&block, 1}});
}

Setting set(const char* key, double value) { return {key, value, ""}; }

using Plant = Twist (*)(const Twist&);
Twist ideal(const Twist& twist) { return twist; }
// Player's driver for the Create: half the requested radius, at most 2 m, in whole millimetres.
Twist player_create(const Twist& twist) {
  if (twist.turn == 0.0) return twist;
  const double radius = std::clamp(std::trunc(std::trunc(1e3 * twist.forward / twist.turn) / 2.0), -2000.0, 2000.0);
  return {twist.forward, 0.0, 1e3 * twist.forward / radius};
}

struct Drive {
  double seconds = 0.0;
  double mean = 0.0, mean_abs = 0.0, largest = 0.0;  // of the error
  double farthest = 0.0;                             // [m] from the lane's centre
  double end = 0.0;                                  // [m] along the path
};

Drive drive(const world::World& world, Controller& controller, std::uint8_t type,
            const std::function<std::vector<double>(const Pose&)>& sense, Plant plant, Pose X_WM = {}) {
  Drive result;
  int steps = 0;
  for (std::int64_t time = 0; time < 1000 * kTick; time += kTick) {
    const Twist twist = step_with(controller, type, sense(X_WM), time, static_cast<std::uint32_t>(time / kTick), X_WM);
    if (controller.done()) break;
    ++steps;
    result.mean += controller.error();
    result.mean_abs += std::abs(controller.error());
    result.largest = std::max(result.largest, std::abs(controller.error()));
    X_WM = robots::advance(X_WM, plant(twist), 0.1);
    result.farthest = std::max(result.farthest, std::abs(world::project_onto(world.paths[0], {X_WM.x, X_WM.y}).offset));
  }
  result.seconds = 0.1 * steps;
  result.mean /= steps;
  result.mean_abs /= steps;
  result.end = world::project_onto(world.paths[0], {X_WM.x, X_WM.y}).s;
  return result;
}

Drive drive_lane(std::vector<Setting> settings, Plant plant, Pose X_WM = {}) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, std::move(settings));
  return drive(
      world, *controller, sensors::kLaneEdge, [&](const Pose& X) { return loop::edge_from(world, X); }, plant, X_WM);
}

// All turning is kp times the error, so a path that turns by 90 degrees determines the mean error.
TEST(LaneKeeping, MeanErrorOfPControlMatchesTheTurn) {
  for (const double kp : {0.5, 0.8, 1.2}) {
    const Drive d = drive_lane({set("kp", kp)}, ideal);
    EXPECT_NEAR(d.mean * kp * d.seconds / (M_PI / 2), 1.0, 0.1) << "kp " << kp;
    EXPECT_NEAR(d.seconds, 53, 3) << "5.28 m at 0.1 m/s";
    EXPECT_LT(d.farthest, 0.25) << "in its lane, kp " << kp;
  }
}

TEST(LaneKeeping, PlayersDriverRoughlyHalvesTheError) {
  const Drive p = drive_lane({set("kp", 0.5)}, player_create);
  const Drive pi = drive_lane({set("kp", 0.5), set("ki", 0.015)}, player_create);
  EXPECT_NEAR(p.mean, 0.027, 0.005) << "thesis: 0.022 to 0.030";
  EXPECT_LT(pi.mean, 0.7 * p.mean);
  EXPECT_GT(pi.mean, 0.0);
}

TEST(LaneKeeping, IntegralReducesTheMeanError) {
  const Drive p = drive_lane({set("kp", 0.5)}, ideal), pi = drive_lane({set("kp", 0.5), set("ki", 0.015)}, ideal);
  EXPECT_LT(std::abs(pi.mean), 0.7 * p.mean);
  const Drive limited = drive_lane({set("kp", 0.5), set("ki", 0.015), set("integral_limit", 1e-6)}, ideal);
  EXPECT_NEAR(limited.mean, p.mean, 1e-4) << "a limit of zero is P control";
}

TEST(LaneKeeping, StopsBeforeTheEndOfThePath) {
  const double length = 2.72 + 0.93 * M_PI / 2 + 1.349;
  EXPECT_NEAR(drive_lane({}, ideal).end, length - 0.25, 0.02);
  EXPECT_NEAR(drive_lane({set("stop_before", 1.0)}, ideal).end, length - 1.0, 0.02);
}

TEST(LaneKeeping, ReturnsToTheMiddle) {
  const Drive d = drive_lane({set("stop_before", 3.2)}, ideal, {0, -0.15, 0, 0});
  EXPECT_NEAR(d.largest, 0.15, 1e-9);
  EXPECT_LT(d.farthest, 0.16);
}

// ---- One step at a time.

struct Step {
  double z;
  double error;
  double turn;
  const char* why;
};

void step_through(Controller& controller, const std::vector<Step>& steps) {
  std::int64_t time = 0;
  std::uint32_t sequence = 0;
  for (const Step& step : steps) {
    const Twist twist = step_with(controller, sensors::kLaneEdge, {step.z, 61, 0, 0}, time, sequence++, {0.5, 0, 0, 0});
    if (std::isnan(step.error)) {
      EXPECT_TRUE(std::isnan(controller.error())) << step.why;
      EXPECT_EQ(twist.forward, 0.0) << step.why;
    } else {
      EXPECT_NEAR(controller.error(), step.error, 1e-12) << step.why;
      EXPECT_EQ(twist.forward, 0.1) << step.why;
    }
    EXPECT_NEAR(twist.turn, step.turn, 1e-12) << step.why;
    time += kTick;
  }
}

TEST(LaneKeeping, ErrorAndTrapezoidMatchHandCalculation) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, {set("kp", 2.0), set("ki", 10.0)});
  step_through(*controller, {{0.35, 0.1, 0.2, "right of the middle: to the left; no time has passed"},
                             {0.45, 0.2, 0.4 + 10 * 0.015, "0.1 s of 0.1 to 0.2"},
                             {0.15, -0.1, -0.2 + 10 * 0.02, "and of 0.2 to -0.1"}});
}

TEST(LaneKeeping, RightEdgeIsMirrored) {
  const world::World world = loop::path_world(-M_PI / 2);  // a sensor that looks to the right
  const auto controller = make(world, lane_keeping_controller, {set("kp", 0.5)});
  step_through(*controller, {{0.35, -0.1, -0.05, "far from the right edge: left of the middle, to the right"}});
}

// A sensor off the robot's axis: the error refers to the axis.
TEST(LaneKeeping, OffAxisSensorMeasuresFromTheAxis) {
  struct Mounted {
    double yaw, y, z, error;
    const char* why;
  };
  for (const Mounted& m : {Mounted{M_PI / 2, 0.1, 0.25, 0.1, "left edge, sensor to the left: 0.35 from the axis"},
                           Mounted{M_PI / 2, -0.1, 0.35, 0.0, "left edge, sensor to the right: 0.25"},
                           Mounted{-M_PI / 2, -0.1, 0.25, -0.1, "right edge, sensor to the right: 0.35"},
                           Mounted{-M_PI / 2, 0.1, 0.35, 0.0, "right edge, sensor to the left: 0.25"}}) {
    world::World world = loop::path_world(m.yaw);
    world.movers[0].sensors[0].X_MS.y = m.y;
    const auto controller = make(world, lane_keeping_controller, {set("kp", 0.5)});
    step_through(*controller, {{m.z, m.error, 0.5 * m.error, m.why}});
  }
}

// With its default gain the whole body stays in the lane, except for a finger's width where the lane narrows to 0.45 m.
TEST(LaneKeeping, DefaultGainKeepsTheLane) {
  for (const auto plant : {&ideal, &player_create})
    for (const double speed : {0.1, 0.2, 0.4}) {
      world::World world = loop::path_world();
      if (plant == &player_create) world.movers[0].actuator_model = world::ActuatorModel::player_create;
      const auto controller = make(world, lane_keeping_controller, {set("speed", speed)});
      const Drive d = drive(
          world, *controller, sensors::kLaneEdge, [&](const Pose& X) { return loop::edge_from(world, X); }, *plant);
      EXPECT_TRUE(controller->done()) << speed;
      EXPECT_LT(d.farthest, plant == &ideal ? 0.07 : 0.1) << speed;
    }
}

TEST(LaneKeeping, DefaultGainDependsOnSpeedAndSensor) {
  const auto gain = [](double speed, double ahead, world::ActuatorModel law = world::ActuatorModel::direct) {
    world::World world = loop::path_world();
    world.movers[0].sensors[0].X_MS.x = ahead;
    world.movers[0].actuator_model = law;
    const auto controller = make(world, lane_keeping_controller, {set("speed", speed), set("half_width", 0.25)});
    return step_with(*controller, sensors::kLaneEdge, {0.35}).turn / 0.1;
  };
  EXPECT_NEAR(gain(0.1, 0.2), 5.0, 1e-9) << "2 v / l^2";
  EXPECT_NEAR(gain(0.05, 0.2), 2.5, 1e-9);
  EXPECT_NEAR(gain(0.1, 0.2, world::ActuatorModel::player_create), 2.5, 1e-9) << "its driver doubles it";
  EXPECT_NEAR(gain(0.4, 0.2), 10.0, 1e-9) << "2 rad/s / l, for steps at 10 Hz";
  EXPECT_NEAR(gain(0.1, -0.1), 20.0, 1e-9) << "as if 0.1 m ahead";
}

TEST(LaneKeeping, StatesItsStopReason) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, {set("hold", 0.5)});
  controller->step({});
  EXPECT_EQ(stop_reason_of(*controller), "no new readings arrive from its lane edge sensor");
  step_with(*controller, sensors::kLaneEdge, {kNaN});
  EXPECT_EQ(stop_reason_of(*controller), "its lane edge sensor detects nothing to follow");
  step_with(*controller, sensors::kLaneEdge, {0.3}, kTick, 1);
  EXPECT_EQ(stop_reason_of(*controller), "") << "it drives";
  step_with(*controller, sensors::kLaneEdge, {0.3}, 10 * kTick, 1);
  EXPECT_EQ(stop_reason_of(*controller), "no new readings arrive from its lane edge sensor") << "the same for too long";
}

TEST(LaneKeeping, GivenWidthOverridesThePath) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, {set("half_width", 0.3), set("kp", 0.5)});
  step_through(*controller, {{0.35, 0.05, 0.025, "half of 0.6 m"}});
}

TEST(LaneKeeping, WithoutAnEdgeItHoldsThenStopsThenContinues) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, {set("kp", 1.0), set("ki", 1.0), set("hold", 0.25)});
  step_through(*controller, {{0.35, 0.1, 0.1, "an edge"},
                             {0.35, 0.1, 0.11, "still"},
                             {kNaN, 0.1, 0.11, "0.1 s without"},
                             {kNaN, 0.1, 0.11, "0.2 s: the integral is kept"},
                             {kNaN, kNaN, 0.0, "0.3 s: stops"},
                             {0.35, 0.1, 0.11, "seen again: the gap is not integrated"},
                             {0.35, 0.1, 0.12, "and on"}});
}

TEST(LaneKeeping, RepeatedReadingIsUsedUntilTheSensorIsSilentTooLong) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller, {set("hold", 0.5), set("kp", 0.5), set("ki", 1.0)});
  int moving = 0;
  double last = 0.0;
  for (int i = 0; i < 20; ++i) {
    const Twist twist = step_with(*controller, sensors::kLaneEdge, {0.35, 61, 0, 0}, i * kTick, 9);
    moving += twist.forward > 0.0;
    if (i == 5) last = twist.turn;
  }
  EXPECT_NEAR(last, 0.05 + 0.5 * 0.1, 1e-12) << "the thesis' loop met readings twice, and integrated them";
  EXPECT_GE(moving, 6);
  EXPECT_LE(moving, 12) << "no new readings count as no edge";
}

TEST(LaneKeeping, StopsWithoutAnyReading) {
  const world::World world = loop::path_world();
  const auto controller = make(world, lane_keeping_controller);
  EXPECT_EQ(controller->step({}).forward, 0.0);
  EXPECT_EQ(step_with(*controller, sensors::kLaneEdge, {}).forward, 0.0);
}

// ---- Magnets.

Drive drive_magnets(std::vector<Setting> settings, Pose X_WM = {}) {
  const world::World world = loop::path_world();
  const auto controller = make(world, magnet_keeping_controller, std::move(settings));
  return drive(
      world, *controller, sensors::kMagnetometer, [&](const Pose& X) { return loop::field_over(world, X); }, ideal,
      X_WM);
}

TEST(MagnetKeeping, MeanErrorOfPControlMatchesTheTurn) {
  for (const double kp : {0.15, 0.2, 0.4}) {
    const Drive d = drive_magnets({set("kp", kp)});
    EXPECT_NEAR(d.mean * kp * d.seconds / (M_PI / 2), 1.0, 0.1) << "kp " << kp;
    EXPECT_LT(d.farthest, 0.25) << "kp " << kp;
    EXPECT_GT(d.end, 5.0);
  }
  const Drive p = drive_magnets({}), pi = drive_magnets({set("ki", 0.02)});
  EXPECT_LT(std::abs(pi.mean), 0.7 * p.mean);
}

TEST(MagnetKeeping, UsesTheOutermostElementsInGauss) {
  const world::World world = loop::path_world();
  const auto controller = make(world, magnet_keeping_controller, {set("kp", 0.5)});
  const std::vector<double> values{0.2e-4, 9, 9, 9, 7, 9, 9, 9, 0.8e-4, 9, 9, 9};  // [T], three elements
  EXPECT_NEAR(step_with(*controller, sensors::kMagnetometer, values).turn, 0.3, 1e-12);
  EXPECT_NEAR(controller->error(), 0.6, 1e-12);
}

TEST(MagnetKeeping, RequiresAnArrayOfTwoElements) {
  const world::World world = loop::path_world();
  const auto controller = make(world, magnet_keeping_controller);
  EXPECT_EQ(step_with(*controller, sensors::kMagnetometer, {1e-4, 0, 0, 0}).forward, 0.0);
  EXPECT_TRUE(std::isnan(controller->error()));
  EXPECT_EQ(controller->step({}).forward, 0.0);
}

}  // namespace
}  // namespace sf::control
