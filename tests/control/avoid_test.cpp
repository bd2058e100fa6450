#include "control/avoid.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "tests/control/closed_loop.h"
#include "tests/control/exploration.h"
#include "tests/units.h"

namespace sf::control {
namespace {

TEST(Thirds, DivideTheFieldOfView) {
  std::vector<double> ranges(361, 0.75);
  ranges[0] = 0.3;
  ranges[119] = 0.31;
  ranges[120] = 0.5;  // exactly -30 degrees: belongs to the front
  ranges[240] = 0.6;  // exactly +30 degrees
  ranges[241] = 0.4;
  const Thirds thirds = thirds_of(ranges);
  EXPECT_EQ(thirds.right, 0.3);
  EXPECT_EQ(thirds.front, 0.5);
  EXPECT_EQ(thirds.left, 0.4);
  EXPECT_EQ(thirds_of(std::vector{kNaN, 0.2, kNaN}).right, HUGE_VAL) << "NaN is ignored";
  EXPECT_EQ(thirds_of(std::vector{kNaN, 0.2, kNaN}).front, 0.2);
  EXPECT_EQ(thirds_of(std::vector{0.5}).left, 0.5) << "too few for three sectors";
}

struct Moment {
  double right, front, left;
  Avoid::State state;
  double forward, turn;
  const char* why;
};

TEST(Avoid, FollowsTheStatesOfTheThesis) {
  using enum Avoid::State;
  Avoid avoid({});
  for (const Moment& m :
       {Moment{0.75, 0.75, 0.75, drive, 0.1, 0, "free"},
        Moment{0.1, 0.41, 0.1, drive, 0.1, 0, "things at the sides do not matter"},
        Moment{0.75, 0.39, 0.75, slow, 0.05, 0, "less than 0.4 m"},
        Moment{0.75, 0.5, 0.75, drive, 0.1, 0, "clear again"},
        Moment{0.3, 0.2, 0.4, slow, 0.05, 0, "0.2 m is the limit"},
        Moment{0.3, 0.19, 0.4, turn_left, 0, 0.5, "more room on the left"},
        Moment{0.6, 0.15, 0.1, turn_left, 0, 0.5, "the direction is kept"},
        Moment{0.6, 0.25, 0.1, slow, 0.05, 0, "out of the front third: straight on, still near"},
        Moment{0.6, 0.15, 0.1, turn_right, 0, -0.5, "a new choice"}, Moment{0.1, 0.75, 0.6, drive, 0.1, 0, "clear"}}) {
    std::vector<double> ranges(9, m.right);
    std::fill(ranges.begin() + 2, ranges.end(), m.front);
    std::fill(ranges.begin() + 7, ranges.end(), m.left);
    const base::ReadingBlock block{.type = sensors::kLaser, .values = ranges};
    const base::Twist twist = avoid.step({.readings = {&block, 1}});
    EXPECT_EQ(avoid.state(), m.state) << m.why;
    EXPECT_EQ(twist.forward, m.forward) << m.why;
    EXPECT_EQ(twist.turn, m.turn) << m.why;
  }
}

TEST(Avoid, TurnsUntilTheConfiguredClearance) {
  Avoid avoid({.clear = 0.4});
  for (const auto& [front, turns] : {std::pair{0.19, true}, {0.39, true}, {0.41, false}, {0.39, false}}) {
    const std::vector<double> ranges(9, front);
    const base::ReadingBlock block{.type = sensors::kLaser, .values = ranges};
    EXPECT_EQ(avoid.step({.readings = {&block, 1}}).turn != 0.0, turns) << front;
  }
}

TEST(Avoid, StopsUntilTheLaserDelivers) {
  Avoid avoid({});
  EXPECT_EQ(avoid.step({}).forward, 0.0);
}

/// Axes up to 30 degrees are in front, those up to 90 at the sides; those behind do not matter.
TEST(Avoid, DrivesBySonarWithoutALaser) {
  world::World world = exploration::boxes(3, 0);
  world::Mover& mover = world.movers.at(0);
  world::Sensor sonar{.type = "sonar", .X_MS = {.yaw = 0.1 * M_PI}};
  const std::vector<double> axes{0, 30, -30, 31, -31, 90, -90, 91, 180};
  sonar.settings.push_back({.key = "scount", .numbers = {static_cast<double>(axes.size())}});
  for (std::size_t i = 0; i < axes.size(); ++i)
    sonar.settings.push_back(
        {.key = fmt::format("spose[{}]", i), .numbers = {0, 0, axes[i] * M_PI / 180 - 0.1 * M_PI}});
  mover.sensors = {sonar};
  const auto made = make_controller({world, 0}, {.name = "avoid", .settings = {"", {}}});
  EXPECT_EQ(made.controller->needs(), 1u << sensors::kSonar);
  const auto twist = [&](std::size_t near, double range, std::uint32_t number) {
    std::vector<double> ranges(axes.size(), 4.0);
    ranges[near] = range;
    const base::ReadingBlock block{.sensor = number, .type = sensors::kSonar, .values = ranges};
    return make_controller({world, 0}, {.name = "avoid", .settings = {"avoid", {{"check_sweep", false}}}})
        .controller->step({.readings = {&block, 1}});
  };
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (const std::uint32_t number : {0u, 1u})  // virtual, and a real robot's own
      EXPECT_EQ(twist(i, 0.15, number).forward > 0.0, i > 2) << axes[i];
}

TEST(Avoid, DrivesInAnEmptyArea) {
  const world::World world = exploration::boxes(3, 0);
  Avoid avoid({});
  loop::LaserRun run(world, avoid);
  for (int i = 0; i < 3000; ++i) run.tick();
  EXPECT_TRUE(run.finite);
  EXPECT_GT(run.distance, 1.0) << "until it scrapes a wall";
}

}  // namespace
}  // namespace sf::control
