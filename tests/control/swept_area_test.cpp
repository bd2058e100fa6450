#include "control/swept_area.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/time.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::control {
namespace {

constexpr base::Twist kBack{-0.3, 0.0, 0.0}, kAhead{0.3, 0.0, 0.0};

world::World box_world() {
  world::World world = scenes::empty_world();
  world::Mover& robot = scenes::add_mover(world, {}, scenes::rectangle({}, 0.6, 0.4));
  robot.max_acceleration = 1.5;
  world::Sensor laser{.type = "laser"};
  laser.settings = {{.key = "samples", .numbers = {3.0}}, {.key = "fov", .numbers = {M_PI}}};
  robot.sensors.push_back(laser);
  return world;
}

// A body of 0.6 m x 0.4 m (its corners are 0.36 m from the origin) with a laser of three beams: right, ahead, left.
struct Box {
  void scan(std::vector<double> ranges, const base::Pose& X_WM, std::int64_t time = 0) {
    const base::ReadingBlock reading{
        .type = sensors::kLaser, .time = time, .X_WM = X_WM, .X_WS = X_WM, .values = ranges};
    swept_area.update({.time = time, .state = {.X_WM = X_WM}, .readings = {&reading, 1}});
  }
  /// Driving with the twist already.
  bool free(const base::Twist& twist, const base::Pose& X_WM = {}) const {
    return swept_area.free({.X_WM = X_WM, .velocity = twist}, twist);
  }
  world::World world = box_world();
  SweptArea swept_area{{world}};
};

TEST(SweptArea, CornersSweepMoreThanTheSides) {
  Box box;
  EXPECT_TRUE(box.free({0.0, 0.0, 1.0})) << "no obstacles";
  box.scan({0.3, 8, 8}, {0.2, 0.0, 0.0, 0.0});  // 0.1 m from the right side, next to the front corner
  EXPECT_TRUE(box.free(kAhead)) << "the side passes it";
  EXPECT_TRUE(box.free({0.0, 0.0, 0.1})) << "the corner comes no nearer than the margin";
  EXPECT_FALSE(box.free({0.0, 0.0, -3.0})) << "the front corner sweeps over it";
}

TEST(SweptArea, BackingOffIsCheckedByEarlierScans) {
  Box box;
  box.scan({8, 0.5, 8}, {0.0, 0.0, 0.0, M_PI});  // an obstacle at x = -0.5
  box.scan({8, 8, 8}, {}, base::kSecond);        // after a turn the laser has left it
  EXPECT_TRUE(box.free({-0.1, 0.0, 0.0})) << "it stops before it";
  EXPECT_FALSE(box.free({-0.5, 0.0, 0.0}));
  EXPECT_TRUE(box.free({0.5, 0.0, 0.0}));
  box.scan({8, 8, 8}, {}, 9 * base::kSecond);
  EXPECT_TRUE(box.free({-0.5, 0.0, 0.0})) << "echoes are forgotten after 8 s";
}

TEST(SweptArea, ABeamThatPassesAnEchoErasesIt) {
  Box box;
  box.scan({8, 0.4, 8}, {});
  EXPECT_FALSE(box.free(kAhead));
  box.scan({8, 8, 8}, {}, base::kSecond / 10);
  EXPECT_TRUE(box.free(kAhead)) << "the obstacle has left";
}

TEST(SweptArea, WithinTheMarginItMayLeaveOnly) {
  Box box;
  box.scan({8, 0.31, 8}, {});  // 1 cm ahead of the front
  EXPECT_FALSE(box.free({0.01, 0.0, 0.0}));
  EXPECT_TRUE(box.free(kBack));
  EXPECT_TRUE(box.free({})) << "a robot at rest sweeps nothing";
}

TEST(SweptArea, OtherRobotsAreDiscsThatBrake) {
  Box box;
  const auto meets = [&](glm::dvec2 p, double speed) {
    const Neighbour other{2, {.X_WM = {p.x, p.y, 0.0, M_PI}, .velocity = {speed, 0.0, 0.0}}, {}};
    box.swept_area.update({.others = {&other, 1}});
    return !box.free(kAhead);
  };
  EXPECT_FALSE(meets({1.0, 0.0}, 0.0)) << "it is at rest, 0.34 m from the front";
  EXPECT_TRUE(meets({1.0, 0.0}, 0.8)) << "it needs 0.33 m to stop";
  EXPECT_TRUE(meets({0.7, 0.0}, 0.0));
  EXPECT_FALSE(meets({0.0, 0.7}, 0.0)) << "at the side";
}

TEST(SweptArea, LimitTakesTheFirstFreeCommand) {
  Box box;
  EXPECT_EQ(box.swept_area.limit({}, kAhead, 1.0, 0.1).forward, kAhead.forward);
  box.scan({8, 0.34, 8}, {});  // 4 cm ahead of the front
  EXPECT_EQ(box.swept_area.limit({}, kAhead, 1.0, 0.1).forward, -0.1) << "the front edge would come nearer in a turn";
  box.scan({8, 0.34, 8}, {0.0, 0.0, 0.0, M_PI}, 1);  // and behind it
  const base::Twist stop = box.swept_area.limit({}, kAhead, 1.0, 0.1);
  EXPECT_EQ(stop.forward, 0.0) << "no way out";
  EXPECT_EQ(stop.turn, 0.0);
}

TEST(SweptArea, IgnoresReadingsOfOtherSizesAndNaN) {
  Box box;
  box.scan({0.1, 0.1}, {});
  box.scan({kNaN, kNaN, kNaN}, {});
  EXPECT_TRUE(box.free(kAhead));
}

}  // namespace
}  // namespace sf::control
