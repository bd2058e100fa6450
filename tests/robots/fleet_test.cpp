#include "robots/fleet.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::robots {
namespace {

using base::Pose;
using base::Report;
using base::Twist;

// State of a world's only robot after `ticks` of one command.
struct Driven {
  Report report;
  int contacts = 0;  // ticks with contact
};

Driven run(const world::World& world, const Twist& command, int ticks, std::size_t row = 0) {
  Fleet fleet(world);
  std::vector<Twist> commands(world.movers.size());
  commands[row] = command;
  Driven result;
  for (int i = 0; i < ticks; ++i) {
    fleet.move(commands, kTick);
    result.contacts += fleet.contacts()[row];
  }
  result.report = fleet.reports()[row];
  return result;
}

TEST(Fleet, StartsAtRestAtTheLoadPoses) {
  world::World world = scenes::boxed_world(4, 4);
  scenes::add_square(world, {2, 2, 0, 1});
  const Fleet fleet(world);
  ASSERT_EQ(fleet.reports().size(), 1u);
  EXPECT_EQ(fleet.reports()[0].X_WM.yaw, 1.0);
  EXPECT_EQ(fleet.reports()[0].velocity.forward, 0.0);
  EXPECT_EQ(fleet.reports()[0].time, 0);
}

TEST(Fleet, DrivesFreely) {
  world::World world = scenes::boxed_world(4, 4);
  scenes::add_square(world, {1, 2, 0, 0});
  const Driven r = run(world, {0.5, 0, 0}, 10);
  EXPECT_NEAR(r.report.X_WM.x, 1.5, 1e-12);
  EXPECT_EQ(r.report.time, 10 * kTick);
  EXPECT_EQ(r.report.velocity.forward, 0.5);
  EXPECT_EQ(r.contacts, 0);
}

TEST(Fleet, PassesTheEndOfAWall) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {1, 0.201}, {1, 3});
  scenes::add_square(world, {0, 0, 0, 0});
  EXPECT_EQ(run(world, {0.5, 0, 0}, 50).contacts, 0);
}

TEST(Fleet, PassesUnderABridge) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {1, -1}, {1, 1}, 1.0, 1.5);
  scenes::add_square(world, {0, 0, 0, 0});
  EXPECT_NEAR(run(world, {0.5, 0, 0}, 50).report.X_WM.x, 2.5, 1e-9);
}

TEST(Fleet, PassesThroughNonObstacles) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {1, -1}, {1, 1});
  world.walls[0].stops_robots = false;
  scenes::add_square(world, {0, 0, 0, 0});
  EXPECT_NEAR(run(world, {0.5, 0, 0}, 50).report.X_WM.x, 2.5, 1e-9);
}

TEST(Fleet, DoesNotSlipBetweenDiagonalCells) {
  // Two solid cells that share one corner leave no gap, although neither has a wall across the path.
  world::World world = scenes::empty_world();
  scenes::add_bitmap(world, {{false, true}, {true, false}}, 1.0);
  scenes::add_create(world, {0.4, 0.4, 0, M_PI / 4});
  const Driven r = run(world, {0.5, 0, 0}, 100);
  EXPECT_LT(r.report.X_WM.x, 1.0);
  EXPECT_GT(r.contacts, 0);
}

TEST(Fleet, DoesNotJumpAPostAtSpeed) {
  world::World world = scenes::empty_world();
  scenes::add_outline(world.walls, scenes::rectangle({1, 0.03}, 0.01, 0.01));
  scenes::add_square(world, {0, 0, 0, 0}).max_forward = 100.0;
  EXPECT_LT(run(world, {100, 0, 0}, 5).report.X_WM.x, 0.8);
}

TEST(Fleet, TwoRobotsMeetHeadOn) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {0, 0, 0, 0});
  scenes::add_square(world, {2, 0, 0, M_PI});
  Fleet fleet(world);
  for (int i = 0; i < 50; ++i) fleet.move(std::vector<Twist>{{0.5, 0, 0}, {0.5, 0, 0}}, kTick);
  const double apart = fleet.reports()[1].X_WM.x - fleet.reports()[0].X_WM.x;
  EXPECT_GT(apart, 0.4);
  EXPECT_LT(apart, 0.4005);
  EXPECT_EQ(fleet.contacts()[0], 1);
  EXPECT_EQ(fleet.contacts()[1], 1);
}

TEST(Fleet, BlockedAheadStillTurnsWherePossible) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.30, -1}, {0.30, 1});
  scenes::add_create(world, {0, 0, 0, 0});
  const Driven r = run(world, {0.5, 0, 0.5}, 12);
  EXPECT_GT(r.report.X_WM.yaw, 0.5);
  EXPECT_GT(r.contacts, 0);
}

/// Of a step that a wall ends, only the rest is a turn in place.
TEST(Fleet, TurnsNoFartherThanCommandedInContact) {
  for (const double at : {0.21, 0.2314, 0.25, 0.2999, 0.30}) {
    world::World world = scenes::empty_world();
    scenes::add_wall(world, {at, -1}, {at, 1});
    scenes::add_create(world, {0, 0, 0, 0});
    Fleet fleet(world);
    const Twist command{0.5, 0, 0.5};
    int contacts = 0;
    for (int i = 0; i < 12; ++i) {
      const double before = fleet.reports()[0].X_WM.yaw;
      fleet.move({&command, 1}, kTick);
      contacts += fleet.contacts()[0];
      EXPECT_LE(fleet.reports()[0].X_WM.yaw - before, 0.5e-9 * kTick * (1.0 + 1e-12)) << at << ", tick " << i;
    }
    EXPECT_GT(contacts, 0) << at;
  }
}

TEST(Fleet, SquareWedgedInASlotCannotTurn) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {-3, 0.21}, {3, 0.21});
  scenes::add_wall(world, {-3, -0.21}, {3, -0.21});
  scenes::add_square(world, {0, 0, 0, 0});
  const Driven r = run(world, {0, 0, 1}, 20);
  EXPECT_LT(std::abs(r.report.X_WM.yaw), 0.1);
  EXPECT_GT(r.contacts, 10);
}

TEST(Fleet, CarDoesNotTurnInPlace) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.2001, -1}, {0.2001, 1});
  scenes::add_square(world, {0, 0, 0, 0}).drive = world::Drive::car;
  const Driven r = run(world, {0.5, 0, 1}, 10);
  EXPECT_EQ(r.report.X_WM.yaw, 0.0);
  EXPECT_EQ(r.contacts, 10);
}

TEST(Fleet, OverlappingStartsSeparate) {
  for (const double offset : {0.0, 0.1, 0.35}) {
    world::World world = scenes::empty_world();
    scenes::add_square(world, {0, 0, 0, 0});
    scenes::add_square(world, {offset, 0, 0, 0});
    EXPECT_NEAR(run(world, {0.5, 0, 0}, 20, 1).report.X_WM.x, offset + 1.0, 1e-9) << "away: free";
    if (offset == 0.0) continue;
    const Driven towards = run(world, {-0.5, 0, 0}, 20, 1);
    EXPECT_NEAR(towards.report.X_WM.x, offset, 1e-9) << "nearer: refused";
    EXPECT_EQ(towards.contacts, 20);
  }
}

TEST(Fleet, StartAcrossAWallLeavesOnlyToTheOriginSide) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.1, -1}, {0.1, 1});
  scenes::add_square(world, {0, 0, 0, 0});
  EXPECT_NEAR(run(world, {-0.5, 0, 0}, 20).report.X_WM.x, -1.0, 1e-9);
  EXPECT_NEAR(run(world, {0.5, 0, 0}, 20).report.X_WM.x, 0.0, 1e-9) << "never through";
}

TEST(Fleet, RobotThatOverlapsOneWallIsStillStoppedByAnother) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.1, -1}, {0.1, 1});
  scenes::add_wall(world, {-0.6, -1}, {-0.6, 1});
  scenes::add_square(world, {0, 0, 0, 0});
  EXPECT_GT(run(world, {-0.5, 0, 0}, 20).report.X_WM.x, -0.4);
}

TEST(Fleet, IsTheSame100KmAway) {
  world::World near = scenes::boxed_world(4, 4), far = scenes::boxed_world(4, 4, {1e5, -1e5});
  scenes::add_create(near, {2, 2, 0, 0.7});
  scenes::add_create(far, {1e5 + 2, -1e5 + 2, 0, 0.7});
  const Driven a = run(near, {0.5, 0, 0.1}, 200), b = run(far, {0.5, 0, 0.1}, 200);
  EXPECT_NEAR(a.report.X_WM.x, b.report.X_WM.x - 1e5, 1e-7);
  EXPECT_NEAR(a.report.X_WM.y, b.report.X_WM.y + 1e5, 1e-7);
  EXPECT_EQ(a.contacts, b.contacts);
}

TEST(Fleet, NewestReportWins) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {});
  Fleet fleet(world);
  const auto at = [](std::int64_t time, double x) { return Report{.mover = 0, .time = time, .X_WM = {x, 0, 0, 0}}; };
  EXPECT_EQ(fleet.apply(std::vector<Report>{at(20, 2), at(10, 1)}), 1u) << "an older report arrives late";
  EXPECT_EQ(fleet.reports()[0].X_WM.x, 2.0);
  EXPECT_EQ(fleet.apply(std::vector<Report>{at(20, 3)}), 1u) << "the same time replaces";
  EXPECT_EQ(fleet.reports()[0].X_WM.x, 3.0);
}

/// Reports place the robot above a kerb, which it then does not touch, and above or below another robot.
TEST(Fleet, ReportedHeightsCountForContacts) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.9, -1}, {0.9, 1}, 0.0, 0.08);  // a kerb
  scenes::add_square(world, {});
  scenes::add_square(world, {5, 0, 0, 0});
  const double top = robots::footprint_of(world.movers[1]).z_max;
  for (const double z : {0.0, 0.07, 0.12, -2.0, top + 0.01}) {
    Fleet fleet(world);
    fleet.apply(std::vector<Report>{{.mover = 0, .time = 1, .X_WM = {0.9, 0, z, 0}}});
    EXPECT_EQ(fleet.predict(1)[0].X_WM.z, z);
    EXPECT_EQ(fleet.contacts()[0], z >= 0.0 && z < 0.08) << z;
    fleet.apply(std::vector<Report>{{.mover = 0, .time = 2, .X_WM = {4.95, 0, z, 0}}});
    fleet.predict(2);
    EXPECT_EQ(fleet.contacts()[0], z >= 0.0 && z < top) << "the other robot, " << z;
  }
}

TEST(Fleet, AbsentRobotTouchesNoOther) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {});
  scenes::add_square(world, {2, 0, 0, 0});
  Fleet fleet(world);
  const std::vector<Report> overlap{{.mover = 0, .time = 1, .X_WM = {2.05, 0, 0, 0}}};
  fleet.set_absent(1, true);
  fleet.apply(overlap);
  fleet.predict(1);
  EXPECT_EQ(fleet.contacts()[0], 0);
  EXPECT_EQ(fleet.contacts()[1], 0);
  fleet.set_absent(1, false);
  fleet.predict(1);
  EXPECT_EQ(fleet.contacts()[0], 1);
}

/// A robot drives through the place of an absent one.
TEST(Fleet, AbsentRobotStopsNoOther) {
  for (const bool gone : {false, true}) {
    world::World world = scenes::empty_world();
    scenes::add_square(world, {});
    scenes::add_square(world, {1, 0, 0, 0});
    Fleet fleet(world);
    fleet.set_absent(1, gone);
    const std::vector<base::Twist> commands{{0.5, 0, 0}, {}};
    for (int i = 0; i < 40; ++i) fleet.move(commands, kTick);
    EXPECT_EQ(fleet.reports()[0].X_WM.x > 1.5, gone);
  }
}

TEST(Fleet, PredictsAlongTheArcForALimitedTime) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {});
  Fleet fleet(world);
  fleet.apply(std::vector<Report>{{.mover = 0, .time = kTick, .X_WM = {}, .velocity = {1, 0, 0}}});
  EXPECT_NEAR(fleet.predict(3 * kTick)[0].X_WM.x, 0.2, 1e-12);
  EXPECT_EQ(fleet.predict(3 * kTick)[0].time, 3 * kTick);
  EXPECT_EQ(fleet.predict(0)[0].X_WM.x, 0.0) << "never backwards";
  EXPECT_NEAR(fleet.predict(100 * kTick)[0].X_WM.x, 0.5, 1e-12) << "coasts half a second";
  EXPECT_EQ(fleet.reports()[0].X_WM.x, 0.0) << "the report is kept";
}

/// 10 km/s with ticks of one second: a free path is not tested at all.
TEST(Fleet, LongFreePathIsNotTested) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {-1, 5}, {20'000, 5});
  scenes::add_square(world, {0, 0, 0, 0}).max_forward = 1e4;
  Fleet fleet(world);
  fleet.move(std::vector<Twist>{{1e4, 0, 0}}, kSecond);
  EXPECT_NEAR(fleet.reports()[0].X_WM.x, 1e4, 1e-8);
  EXPECT_EQ(fleet.reports()[0].velocity.forward, 1e4);
  EXPECT_EQ(fleet.steps_tested(), 0u);
  EXPECT_EQ(fleet.contacts()[0], 0);
}

/// Walls and robots at the end of a long path stop the mover. Near them it is tested step by step.
TEST(Fleet, LongPathEndsAtAnObstacle) {
  for (const bool robot : {false, true}) {
    world::World world = scenes::empty_world();
    scenes::add_square(world, {0, 0, 0, 0}).max_forward = 1e4;
    if (robot) scenes::add_square(world, {7'000.2, 0, 0, 0});
    if (!robot) scenes::add_wall(world, {7'000, -1}, {7'000, 1});
    Fleet fleet(world);
    std::vector<Twist> commands(world.movers.size());
    commands[0] = {1e4, 0, 0};
    fleet.move(commands, kSecond);
    EXPECT_LE(fleet.reports()[0].X_WM.x, 6'999.8) << robot;
    EXPECT_GE(fleet.reports()[0].X_WM.x, 6'999.7995) << robot;
    EXPECT_EQ(fleet.contacts()[0], 1) << robot;
    EXPECT_LE(fleet.steps_tested(), 4'096u) << robot;
  }
}

/// The bound of work: a mover that passes close to a wall for kilometres ends its tick after 16384 substeps.
TEST(Fleet, LongPathAlongAWallEndsAtTheBoundOfWork) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {-1, 0.21}, {20'000, 0.21});
  scenes::add_square(world, {0, 0, 0, 0}).max_forward = 1e4;
  Fleet fleet(world);
  fleet.move(std::vector<Twist>{{1e4, 0, 0}}, kSecond);
  EXPECT_NEAR(fleet.reports()[0].X_WM.x, 16'384 * 0.05, 1.0);
  EXPECT_EQ(fleet.reports()[0].velocity.forward, 1e4) << "it continues in the next tick";
  EXPECT_EQ(fleet.contacts()[0], 0);
  EXPECT_LE(fleet.steps_tested(), Fleet::kRounds * 16'384u);
}

/// A million radians per second: a spin in place is free exactly if the disc of the body is.
TEST(Fleet, SpinInTheOpenIsNotTested) {
  world::World world = scenes::boxed_world(2, 2);
  scenes::add_square(world, {1, 1, 0, 0}).max_turn = 1e6;
  Fleet fleet(world);
  fleet.move(std::vector<Twist>{{0, 0, 1e6}}, kSecond);
  EXPECT_EQ(fleet.steps_tested(), 0u);
  EXPECT_NEAR(std::abs(base::wrap_angle(fleet.reports()[0].X_WM.yaw - base::wrap_angle(1e6))), 0.0, 1e-9);
}

/// Just below and above 1024 substeps, where testing in pieces begins, the path is the same except for rounding.
TEST(Fleet, PathInPiecesEqualsWholePath) {
  for (const double speed : {51.0, 51.3, 60.0, 200.0}) {
    world::World world = scenes::empty_world();
    scenes::add_wall(world, {-1, 0.4}, {300, 0.4});
    scenes::add_wall(world, {speed - 0.5, -1}, {speed - 0.5, 1});
    scenes::add_square(world, {0, 0, 0, 0}).max_forward = speed;
    Fleet fleet(world);
    fleet.move(std::vector<Twist>{{speed, 0, 0}}, kSecond);
    EXPECT_NEAR(fleet.reports()[0].X_WM.x, speed - 0.7, 5e-4) << speed;
    EXPECT_EQ(fleet.contacts()[0], 1) << speed;
  }
}

TEST(Fleet, AnyCommandKeepsTheRobotWithinItsLimits) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {1, 2, 0, 0.5});
  constexpr double kInf = std::numeric_limits<double>::infinity(), kMost = std::numeric_limits<double>::max();
  for (const double command : {std::nan(""), kInf, -kInf, kMost, std::numeric_limits<double>::denorm_min()}) {
    const Pose X = run(world, {command, command, command}, 1).report.X_WM;
    EXPECT_TRUE(std::isfinite(X.x) && std::isfinite(X.y) && std::isfinite(X.yaw)) << command;
    EXPECT_LE(std::hypot(X.x - 1.0, X.y - 2.0), 0.1 * world.movers[0].max_forward * (1.0 + 1e-12)) << command;
    EXPECT_TRUE(std::isfinite(command) || (X.x == 1.0 && X.y == 2.0 && X.yaw == 0.5)) << command << " is ignored";
  }
}

/// The arc of 1 m radius: ticks of 1 us for 0.1 s, and one tick of 10 s.
TEST(Fleet, ShortAndLongTicksDriveTheSameArc) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {});
  const Twist arc{0.3, 0.0, 0.3};
  for (const auto& [dt, ticks] : {std::pair<std::int64_t, int>{1000, 100'000}, {10 * kSecond, 1}}) {
    Fleet fleet(world);
    for (int i = 0; i < ticks; ++i) fleet.move({&arc, 1}, dt);
    const double angle = 0.3e-9 * static_cast<double>(dt * ticks);
    EXPECT_NEAR(fleet.reports()[0].X_WM.x, std::sin(angle), 1e5 * 3 * 2.2e-16) << dt;
    EXPECT_NEAR(fleet.reports()[0].X_WM.y, 1.0 - std::cos(angle), 1e5 * 3 * 2.2e-16) << dt;
  }
}

}  // namespace
}  // namespace sf::robots
