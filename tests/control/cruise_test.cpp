#include "control/cruise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robots/kinematics.h"
#include "tests/refusal.h"
#include "tests/units.h"
#include "world/roads/roads.h"
#include "world/world.h"

namespace sf::control {
namespace {

constexpr double kBendRadius = 60.0;  // [m]

/// A circle to the left, or a part of it, from (0, 0) towards +x.
world::RoadLane bend_of(double turn) {
  std::vector<glm::dvec2> points;
  const int count = static_cast<int>(turn / (10.0 * kDegree));
  for (int i = 0; i <= count; ++i)
    points.push_back(kBendRadius * glm::dvec2{std::sin(turn * i / count), 1.0 - std::cos(turn * i / count)});
  return {.width = 3.5, .centre = world::smooth_curve(points, {})};
}

/// Drives a car of 15 m/s at most. Returns the largest offset [m] after 5 s, and where it is at the end.
struct Cruised {
  double largest = 0.0, forward = 0.0;
  base::Report at;
};
Cruised cruise_for(Cruise& cruise, double seconds, const std::vector<Neighbour>& others = {}) {
  Cruised drive{.at = {.X_WM = {0.0, 0.5, 0.0, 0.0}}};
  for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i) {
    base::Twist twist = cruise.step({.time = i * kTick / 2, .state = drive.at, .others = others});
    // A car needs time for its speed.
    const double v = drive.at.velocity.forward;
    twist.turn *= twist.forward > 0.0 ? v / twist.forward : 0.0;
    twist.forward = v + std::clamp(twist.forward - v, -0.4, 0.15);
    drive.at = {.X_WM = robots::advance(drive.at.X_WM, twist, 0.05), .velocity = twist};
    if (i > 100) drive.largest = std::max(drive.largest, std::abs(cruise.error()));
  }
  drive.forward = drive.at.velocity.forward;
  return drive;
}

TEST(Cruise, KeepsToItsLaneAndGoesRoundAClosedOne) {
  Cruise cruise(bend_of(2.0 * M_PI), true, {.speed = 10.0});
  const Cruised once = cruise_for(cruise, 60.0);
  EXPECT_LT(once.largest, 0.1) << "more than one round, the start included";
  EXPECT_NEAR(once.forward, 10.0, 0.01);
  EXPECT_FALSE(cruise.done());
}

TEST(Cruise, SlowsDownInBends) {
  Cruise cruise(bend_of(2.0 * M_PI), true, {.speed = 15.0, .sideways = 1.5});
  EXPECT_NEAR(cruise_for(cruise, 30.0).forward, std::sqrt(1.5 * kBendRadius), 0.4)
      << "v^2 / r is the limit, for a polyline";
}

TEST(Cruise, StopsAtTheEndOfAnOpenLane) {
  Cruise cruise(bend_of(M_PI), false, {.speed = 10.0});
  const base::Pose end = cruise_for(cruise, 60.0).at.X_WM;
  EXPECT_TRUE(cruise.done());
  EXPECT_LT(std::hypot(end.x, end.y - 2.0 * kBendRadius), 10.0);
}

TEST(Cruise, KeepsItsDistanceToARobotInItsLaneOnly) {
  const double angle = 100.0 * kDegree;
  const auto ahead = [&](double radius) {
    Neighbour other{.id = 2};
    other.state.X_WM = {radius * std::sin(angle), kBendRadius - radius * std::cos(angle), 0.0, angle};
    return std::vector{other};
  };
  Cruise behind(bend_of(2.0 * M_PI), true, {.speed = 10.0, .gap = 8.0}),
      beside(bend_of(2.0 * M_PI), true, {.speed = 10.0});
  const std::vector<Neighbour> other = ahead(kBendRadius);
  const base::Pose at = cruise_for(behind, 60.0, other).at.X_WM;
  EXPECT_NEAR(std::hypot(at.x - other[0].state.X_WM.x, at.y - other[0].state.X_WM.y), 8.0, 0.5) << "the gap at rest";
  EXPECT_NE(behind.stop_reason(), "");
  EXPECT_NEAR(cruise_for(beside, 30.0, ahead(kBendRadius + 3.5)).forward, 10.0, 0.01) << "it is in the next lane";
}

TEST(Cruise, NeedsALaneOfTheRoads) {
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world");
  const world::RoadNetwork roads = world::load_roads(SF_SOURCE_DIR "/worlds/simville/simville.rndf", world.warnings);
  const auto refused = [&](std::vector<Setting> settings, const world::RoadNetwork* network) {
    return refusal_of([&] {
      Settings read("controller 'cruise'", std::move(settings));
      cruise_controller.make({.world = world, .mover = 0, .roads = network}, read);
    });
  };
  expect_in("there is no lane '9.9' with a direction; expected one such as lane=1.1",
            refused({{"lane", std::string("9.9"), ""}}, &roads));
  expect_in("there is no lane ''", refused({}, &roads));
  expect_in("no road network", refused({{"lane", std::string("1.1"), ""}}, nullptr));
  EXPECT_EQ(refused({{"lane", std::string("1.1"), ""}}, &roads), "");
}

}  // namespace
}  // namespace sf::control
