#include "control/docking.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::control {
namespace {

using base::Pose;

constexpr double kRange = 1.8, kFov = 0.7, kHalo = 0.6;

// The dock's light by formula, at a receiver in the robot's centre: the red buoy's beam on the left, the green one's on
// the right, each overlapping by a quarter. (tests/scenarios/docking_test.cpp has the shipped receiver and dock.)
double byte_at(const Pose& X_WD, glm::dvec2 p) {
  const glm::dvec2 from = base::rotate(-X_WD.yaw, p - glm::dvec2{X_WD.x, X_WD.y});
  const double bearing = std::atan2(from.y, from.x), far = glm::length(from);
  int byte = far <= kHalo ? 2 : 0;
  if (far <= kRange && std::abs(bearing - 0.375 * kFov) <= 0.5 * kFov) byte += 8;
  if (far <= kRange && std::abs(bearing + 0.375 * kFov) <= 0.5 * kFov) byte += 4;
  return byte == 0 ? 255.0 : 240.0 + byte;
}

/// One step of a robot at `X_WM` that receives `byte`.
base::Twist step_at(Controller& controller, const Pose& X_WM, double byte, std::int64_t time = 0,
                    bool contact = false) {
  const std::vector<double> values{0.0, byte};
  const base::ReadingBlock block{.type = 11, .values = values};
  return controller.step({.time = time, .state = {.X_WM = X_WM}, .readings = {&block, 1}, .contact = contact});
}

struct Docked {
  bool done = false;
  double aside = 0.0;  // [m] from the dock's axis
  double off = 0.0;    // [rad] deviation from facing it
  double far = 0.0;    // [m]
  double seconds = 0.0;
};

Docked dock(const Pose& X_WD, const Pose& from, bool solid) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, from).sensors.push_back({.type = "irreceiver"});
  world.emitters.push_back(
      {.kind = world::Emitter::Kind::dock, .X_WE = X_WD, .range = kRange, .fov = kFov, .halo = kHalo});
  if (solid) {  // a face across the axis that the bumper hits
    scenes::add_wall(world, base::transform(X_WD, {0.08, -0.15}), base::transform(X_WD, {0.08, 0.15}));
  }
  Settings settings("controller 'docking'", {});
  const auto controller = docking_controller.make({world}, settings);
  robots::Fleet fleet(world);
  Docked result;
  for (int i = 0; i < 2400 && !controller->done(); ++i) {
    const Pose& X = fleet.reports()[0].X_WM;
    const base::Twist command[] = {
        step_at(*controller, X, byte_at(X_WD, {X.x, X.y}), i * kTick, fleet.contacts()[0] != 0)};
    EXPECT_TRUE(controller->intent().docking);
    fleet.move(command, kTick);
    result.seconds += 0.1;
  }
  const Pose& X = fleet.reports()[0].X_WM;
  const glm::dvec2 at = base::rotate(-X_WD.yaw, glm::dvec2{X.x, X.y} - glm::dvec2{X_WD.x, X_WD.y});
  return {controller->done(), std::abs(at.y), std::abs(base::wrap_angle(X.yaw - X_WD.yaw - M_PI)), glm::length(at),
          result.seconds};
}

TEST(Docking, FollowsTheBeamsOfARealRobotsOwnReceiver) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, {1.2, 0.3, 0.0, M_PI}).sensors.push_back({.type = "irreceiver"});
  world.emitters.push_back(
      {.kind = world::Emitter::Kind::dock, .X_WE = {}, .range = kRange, .fov = kFov, .halo = kHalo});
  Settings settings("controller 'docking'", {});
  const auto alone = docking_controller.make({world}, settings), both = docking_controller.make({world}, settings);
  const std::vector<double> dark{0.0, 255.0}, light{0.0, 252.0};
  const base::ReadingBlock blocks[] = {{.sensor = 0, .type = 11, .values = dark},
                                       {.sensor = 1, .type = 11, .values = light}};
  const ControllerInput input{.state = {.X_WM = {1.2, 0.3, 0.0, M_PI}}, .readings = blocks};
  const base::Twist expected = step_at(*alone, input.state.X_WM, 252.0), twist = both->step(input);
  EXPECT_EQ(twist.forward, expected.forward);
  EXPECT_EQ(twist.turn, expected.turn);
}

TEST(Docking, DocksFromAnywhereInFrontOfTheDock) {
  for (std::uint32_t i = 0; i < 40; ++i) {
    const auto u = base::random_uniform({.seed = 5, .a = i}, 0),
               v = base::random_uniform({.seed = 5, .a = i, .b = 1}, 0);
    const Pose X_WD{3.0, -2.0, 0.0, 6.28 * u[0]};
    const Pose from = base::compose(X_WD, {0.6 + 2.0 * u[1], 3.0 * v[0] - 1.5, 0.0, 6.28 * v[1]});
    for (const bool solid : {false, true}) {
      const Docked d = dock(X_WD, from, solid);
      ASSERT_TRUE(d.done) << i;
      EXPECT_LT(d.aside, 0.05) << i;
      EXPECT_LT(d.off, 0.75) << i;
      EXPECT_LT(d.far, solid ? 0.26 : 0.2) << i;
      EXPECT_LT(d.seconds, 120) << i;
    }
  }
}

struct Seen {
  double byte;
  double turn;  // its sign
  double forward;
  const char* why;
};

TEST(Docking, FollowsTheLineBetweenTheBuoys) {
  const Pose X_WD{};  // beams along x; the robot faces it
  for (const Seen& s : {Seen{252, 0, 0.1, "both"}, Seen{254, 0, 0.03, "both, in the force field: slowly"},
                        Seen{248, 1, 0.1 * std::cos(0.7), "red alone: to the left, driving"},
                        Seen{244, -1, 0.1 * std::cos(0.7), "green alone: to the right"},
                        Seen{250, 1, 0.03 * std::cos(0.7), "red, in the field"},
                        Seen{246, -1, 0.03 * std::cos(0.7), "green, in the field"}}) {
    Docking docking({.X_WD = X_WD});
    step_at(docking, {1.2, 0, 0, M_PI}, 252.0);
    const base::Twist twist = step_at(docking, {1.0, 0, 0, M_PI}, s.byte);
    EXPECT_NEAR(twist.forward, s.forward, 1e-12) << s.why;
    EXPECT_EQ(std::abs(twist.turn) < 1e-9 ? 0.0 : std::copysign(1.0, twist.turn), s.turn) << s.why;
  }
}

TEST(Docking, WithoutLightItDrivesToTheStagingPoint) {
  for (const double byte : {255.0, 242.0, 240.0, 130.0, std::nan("")}) {
    Docking docking({.X_WD = {}, .stage = 1.0});
    const base::Twist twist = step_at(docking, {1.0, 2.0, 0, -M_PI / 2}, byte);
    EXPECT_EQ(twist.forward, 0.1) << byte;
    EXPECT_NEAR(twist.turn, 0.0, 1e-9) << byte;
  }
}

TEST(Docking, SelectsTheNearestOrTheNamedDock) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, {}).sensors.push_back({.type = "irreceiver"});
  for (const auto& [name, x] : {std::pair{"behind", -6.0}, {"near", 3.0}, {"far", 9.0}}) {
    const auto model = static_cast<std::uint32_t>(world.models.size());
    world.models.push_back({.name = name});
    world.emitters.push_back({.kind = world::Emitter::Kind::dock,
                              .model = model,
                              .X_WE = {x, 0.0, 0.0, x > 0.0 ? M_PI : 0.0},
                              .range = kRange,
                              .fov = kFov,
                              .halo = kHalo});
  }
  const auto turns = [&](std::vector<Setting> named) {
    Settings settings("controller 'docking'", std::move(named));
    return std::abs(docking_controller.make({world}, settings)->step({}).turn) > 0.1;
  };
  EXPECT_FALSE(turns({})) << "straight ahead";
  EXPECT_TRUE(turns({{"dock", std::string("behind"), ""}}));
  EXPECT_FALSE(turns({{"dock", std::string("far"), ""}}));
  world.movers[0].X_WM.x = -4.0;
  EXPECT_TRUE(turns({})) << "now the one behind is nearest";
}

TEST(Docking, WithOneBuoyItDrivesToTheStagingPointUntilItReceivesBoth) {
  for (const double byte : {248.0, 250.0}) {
    Docking docking({.X_WD = {}, .stage = 1.0});
    const base::Twist twist = step_at(docking, {0.4, 0.2, 0, 0}, byte);
    EXPECT_LT(twist.turn, 0.0) << "to (1, 0), away from the dock";
    EXPECT_NEAR(twist.turn, 3.0 * std::atan2(-0.2, 0.6), 1e-9);
  }
}

// A turn in place moves the receiver from beam to beam, and when facing away from the dock the shorter direction
// differs between beams. The robot keeps the direction in which it began.
TEST(Docking, TurnInPlaceKeepsItsDirection) {
  Docking docking({.X_WD = {}});
  const auto step = [&](double yaw, double byte) { return step_at(docking, {1.0, 0.0, 0, yaw}, byte); };
  EXPECT_GT(step(0.1, 252.0).turn, 0.5) << "to the dock's heading, pi, by the left";
  const base::Twist red = step(0.2, 248.0);
  EXPECT_GT(red.turn, 0.5) << "to pi + 0.7, which is nearer by the right";
  EXPECT_EQ(red.forward, 0.0) << "not away from the dock";
  EXPECT_GT(step(0.3, 244.0).turn, 0.5);
}

TEST(Docking, ContinuesWithoutLightForAMomentThenReturns) {
  Docking docking({.X_WD = {}, .stage = 1.0});
  const auto step = [&](double seconds, double byte) {
    return step_at(docking, {0.8, 0.0, 0, M_PI}, byte, static_cast<std::int64_t>(1e9 * seconds));
  };
  step(0.0, 252.0);
  EXPECT_NEAR(step(2.0, 255.0).forward, 0.1, 1e-12) << "two seconds";
  EXPECT_EQ(step(2.1, 255.0).forward, 0.0) << "longer: it turns to the staging point behind it";
}

TEST(Docking, ContactElsewhereIsNotDocking) {
  struct Touch {
    Pose X;
    bool docked;
    const char* why;
  };
  for (const Touch& t :
       {Touch{{1.5, 0, 0, M_PI}, false, "far from it"}, Touch{{0.25, 0, 0, M_PI}, true, "its face"},
        Touch{{0.25, 0.07, 0, M_PI - 0.5}, true, "slightly off the axis and rotated"},
        Touch{{0.25, 0.1, 0, M_PI}, false, "next to it"}, Touch{{0.25, 0, 0, M_PI - 0.7}, false, "not facing it"},
        Touch{{-0.25, 0, 0, M_PI}, false, "its back"}}) {
    Docking docking({.X_WD = {}});
    docking.step({.state = {.X_WM = t.X}, .contact = true});
    EXPECT_EQ(docking.done(), t.docked) << t.why;
    EXPECT_EQ(docking.stop_reason().empty(), t.docked) << t.why;
  }
}

TEST(Docking, LeavesTheForceFieldAfterAContact) {
  Docking docking({.X_WD = {}, .stage = 1.0});
  step_at(docking, {0.3, 0.0, 0, M_PI - 1.0}, 254, 0, true);
  EXPECT_EQ(step_at(docking, {0.5, 0.0, 0, 0.0}, 254).forward, 0.1) << "away, though it sees both buoys";
  EXPECT_EQ(step_at(docking, {0.8, 0.0, 0, 0.0}, 252).forward, 0.0) << "beyond the field: it turns to the dock";
}

TEST(Docking, ReachesTheStagingPointWithinTwoCentimetresAfterAContact) {
  for (const double off : {0.02, 0.019}) {
    Docking docking({.X_WD = {}, .stage = 1.0});
    docking.step({.state = {.X_WM = {0.3, 0.1, 0, M_PI}}, .contact = true});  // at the dock's corner
    step_at(docking, {1.0, off, 0, M_PI}, 254.0);
    const double forward = step_at(docking, {1.0, off, 0, M_PI}, 254.0).forward;
    EXPECT_EQ(forward, off < 0.02 ? 0.03 : 0.0) << "it follows the beams, or turns to the staging point";
  }
}

TEST(Docking, BacksOffFromAnObstacleAndDrivesAroundIt) {
  Docking docking({.X_WD = {}, .stage = 1.0});
  step_at(docking, {1.5, 0.0, 0, M_PI}, 255);
  EXPECT_EQ(step_at(docking, {1.5, 0.0, 0, M_PI}, 255, 0, true).forward, -0.1);
  EXPECT_EQ(step_at(docking, {1.51, 0.0, 0, M_PI}, 255, 9 * kTick).forward, -0.1) << "less than a second";
  EXPECT_GT(std::abs(step_at(docking, {1.6, 0.0, 0, M_PI}, 252, 10 * kTick).turn), 0.3) << "not into it again";
}

// Between an obstacle behind and one ahead it backs off from each in turn.
TEST(Docking, DrivesForwardWhenItTouchesSomethingWhileBackingOff) {
  Docking docking({.X_WD = {}, .stage = 1.0});
  step_at(docking, {1.5, 0.0, 0, M_PI}, 255, 0, true);
  step_at(docking, {1.52, 0.0, 0, M_PI}, 255, kTick);
  EXPECT_EQ(step_at(docking, {1.54, 0.0, 0, M_PI}, 255, 2 * kTick, true).forward, 0.1);
}

TEST(Docking, DrivesAroundTheDockFromBehind) {
  for (const double side : {1.0, -1.0}) {
    Docking docking({.X_WD = {}, .stage = 1.0});
    const auto heading = [&](double x, double y) {
      // It does not turn if it faces its goal.
      for (double yaw = -M_PI; yaw < M_PI; yaw += 0.01) {
        const base::Twist twist = docking.step({.state = {.X_WM = {x, y, 0, yaw}}});
        if (twist.forward > 0.0 && std::abs(twist.turn) < 0.016) return yaw;
      }
      return 9.0;
    };
    EXPECT_NEAR(heading(-0.5, 0.05 * side), side * M_PI / 2, 0.02) << "aside";
    EXPECT_NEAR(heading(-0.5, 0.31 * side), side * 0.01, 0.02) << "past it";
    EXPECT_NEAR(heading(0.3, 0.3 * side), -side * 0.4, 0.02) << "to its place";
  }
}

}  // namespace
}  // namespace sf::control
