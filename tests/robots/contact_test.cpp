// Stopping distances and contact sectors of movers.

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "robots/fleet.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"

namespace sf::robots {
namespace {

using base::Pose;
using base::Report;
using base::Twist;

std::uint32_t sector_bit(int k) { return 1u << ((k + 32) % 32); }

void drive(Fleet& fleet, std::vector<Twist> commands, int ticks = 1) {
  for (int i = 0; i < ticks; ++i) fleet.move(commands, kTick);
}

double gap_to(const world::World& world, const Pose& X_WM, const world::Mover& mover) {
  double gap = HUGE_VAL;
  for (const world::Segment& s : mover.body)
    for (const world::Segment& wall : world.walls)
      gap = std::min({gap, world::distance(transform(X_WM, s.a), wall.a, wall.b),
                      world::distance(wall.a, transform(X_WM, s.a), transform(X_WM, s.b)),
                      world::distance(wall.b, transform(X_WM, s.a), transform(X_WM, s.b))});
  return gap;
}

TEST(Contact, RobotStopsWithinHalfAMillimetreOfAnyObstacle) {
  for (std::uint32_t k = 0; k < 60; ++k) {
    const auto u = base::random_uniform({.seed = 31, .stream = base::RandomStream::placement, .a = k}, 0);
    world::World world = scenes::boxed_world(2, 2);
    scenes::add_outline(world.walls, scenes::rectangle({1.5, 0.4}, 0.1, 0.1));
    const Pose X{0.4 + 0.7 * u[0], 0.9 + 0.7 * u[1], 0, 6.28 * std::fmod(7.0 * u[0] + u[1], 1.0)};
    const world::Mover& mover = k % 2 == 0 ? scenes::add_create(world, X) : scenes::add_square(world, X);
    Fleet fleet(world);
    for (int i = 0; i < 100 && fleet.contacts()[0] == 0; ++i) drive(fleet, {{0.2 + 0.3 * u[1], 0, 0}});
    ASSERT_EQ(fleet.contacts()[0], 1) << k;
    const double gap = gap_to(world, fleet.reports()[0].X_WM, mover);
    EXPECT_LE(gap, 5e-4) << k;
    EXPECT_NE(fleet.reports()[0].contact_mask, 0u) << k;
    const Pose stopped = fleet.reports()[0].X_WM;
    drive(fleet, {{0.5, 0, 0}}, 5);
    EXPECT_LT(std::hypot(fleet.reports()[0].X_WM.x - stopped.x, fleet.reports()[0].X_WM.y - stopped.y), 1e-3)
        << "and stays there, however long it presses";
  }
}

TEST(Contact, SectorsFaceTheWall) {
  for (const auto& [yaw, sectors] :
       {std::pair{0.0, sector_bit(0) | sector_bit(-1)}, {M_PI / 2, sector_bit(7) | sector_bit(8)}}) {
    world::World world = scenes::empty_world();
    scenes::add_wall(world, {0.5, -1}, {0.5, 1});
    scenes::add_create(world, {0, 0, 0, 0}).drive = world::Drive::omni;
    Fleet fleet(world);
    // Drives towards the wall with the side to test in front; contact sectors are in the robot's frame.
    const_cast<world::Mover&>(world.movers[0]).X_WM.yaw = -yaw;
    Fleet turned(world);
    drive(turned, {{0.5 * std::cos(yaw), 0.5 * std::sin(yaw), 0}}, 20);
    EXPECT_EQ(turned.reports()[0].contact_mask, sectors) << yaw;
    EXPECT_NEAR(turned.reports()[0].X_WM.x, 0.335, 5e-4);
  }
}

TEST(Contact, LastsWhileTouchingAndEndsOnLeaving) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.5, -1}, {0.5, 1});
  scenes::add_create(world, {0, 0, 0, 0});
  Fleet fleet(world);
  drive(fleet, {{0.5, 0, 0}}, 20);
  const std::uint32_t pressed = fleet.reports()[0].contact_mask;
  EXPECT_NE(pressed, 0u);
  drive(fleet, {{0, 0, 0}}, 10);
  EXPECT_EQ(fleet.reports()[0].contact_mask, pressed) << "a bumper stays pressed while its robot is at rest";
  EXPECT_EQ(fleet.contacts()[0], 1);
  drive(fleet, {{-0.005, 0, 0}});  // 0.5 mm: still in contact
  EXPECT_EQ(fleet.contacts()[0], 1);
  drive(fleet, {{-0.02, 0, 0}});
  EXPECT_EQ(fleet.reports()[0].contact_mask, 0u);
  EXPECT_EQ(fleet.contacts()[0], 0);
}

TEST(Contact, PassingByDoesNotCount) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {-5, 0.2005}, {5, 0.2005});
  scenes::add_square(world, {0, 0, 0, 0});
  Fleet fleet(world);
  drive(fleet, {{0.5, 0, 0}}, 10);
  EXPECT_EQ(fleet.reports()[0].contact_mask, 0u) << "half a millimetre away, but it was not stopped";
  EXPECT_EQ(fleet.contacts()[0], 0);
}

TEST(Contact, IsReportedByBothRobots) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {0, 0, 0, M_PI});  // with its back to the other
  scenes::add_square(world, {1, 0, 0, M_PI});
  scenes::add_square(world, {-0.4005, 0, 0, 0});  // at rest
  Fleet fleet(world);
  drive(fleet, {{}, {0.5, 0, 0}, {}}, 20);
  EXPECT_EQ(fleet.contacts()[0], 1);
  EXPECT_EQ(fleet.contacts()[1], 1);
  EXPECT_NE(fleet.reports()[0].contact_mask & (sector_bit(15) | sector_bit(16)), 0u) << "behind";
  EXPECT_NE(fleet.reports()[1].contact_mask & (sector_bit(0) | sector_bit(-1)), 0u) << "ahead";
  EXPECT_EQ(fleet.contacts()[2], 0) << "no robot ran into the third";
  drive(fleet, {{}, {-0.5, 0, 0}, {}}, 1);
  EXPECT_EQ(fleet.contacts()[1], 0);
  EXPECT_EQ(fleet.reports()[0].contact_mask & (sector_bit(15) | sector_bit(16)), 0u) << "released on that side";
}

TEST(Contact, RoundRobotCanTurnWhicheverSideTouches) {
  for (int k = 0; k < 32; ++k) {
    world::World world = scenes::empty_world();
    scenes::add_wall(world, {0.5, -1}, {0.5, 1});
    world::Mover& mover = scenes::add_create(world, {0.2, 0, 0, k * M_PI / 128});
    mover.drive = world::Drive::omni;
    Fleet fleet(world);
    const double yaw = k * M_PI / 128;
    drive(fleet, {{0.5 * std::cos(yaw), -0.5 * std::sin(yaw), 0}}, 10);
    ASSERT_EQ(fleet.contacts()[0], 1);
    const Pose pressed = fleet.reports()[0].X_WM;
    drive(fleet, {{0, 0, 1.0}}, 20);
    EXPECT_NEAR(fleet.reports()[0].X_WM.yaw, base::wrap_angle(yaw + 2.0), 1e-9) << k;
    EXPECT_NEAR(fleet.reports()[0].X_WM.x, pressed.x, 0.012) << k << ": pushed off by no more than it sticks out";
    EXPECT_NEAR(fleet.reports()[0].X_WM.y, pressed.y, 0.012) << k;
  }
}

TEST(Contact, AccelerationsLimitDrivingButNotStopping) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.5, -1}, {0.5, 1});
  scenes::add_create(world, {0, 0, 0, 0}).max_acceleration = 1.0;
  Fleet fleet(world);
  drive(fleet, {{0.5, 0, 0}});
  EXPECT_DOUBLE_EQ(fleet.reports()[0].velocity.forward, 0.1);
  EXPECT_NEAR(fleet.reports()[0].X_WM.x, 0.01, 1e-12);
  drive(fleet, {{0.5, 0, 0}}, 2);
  EXPECT_DOUBLE_EQ(fleet.reports()[0].velocity.forward, 0.3);
  drive(fleet, {{0, 0, 0}});
  EXPECT_DOUBLE_EQ(fleet.reports()[0].velocity.forward, 0.2) << "rolls on";
  drive(fleet, {{0.5, 0, 0}}, 20);
  EXPECT_EQ(fleet.reports()[0].velocity.forward, 0.0) << "stopped at once";
  drive(fleet, {{-0.5, 0, 0}});
  EXPECT_DOUBLE_EQ(fleet.reports()[0].velocity.forward, -0.1) << "and starts from rest";
}

TEST(Contact, ActuatorModelIsAppliedFirst) {
  world::World world = scenes::empty_world();
  world::Mover& mover = scenes::add_create(world, {0, 0, 0, 0});
  mover.track = 0.258;
  mover.actuator_model = world::ActuatorModel::player_create;
  Fleet fleet(world);
  drive(fleet, {{0.1, 0, 0.1}});
  EXPECT_DOUBLE_EQ(fleet.reports()[0].velocity.turn, 0.2);
}

TEST(Contact, ReportedRobotTouchesVirtualObjects) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {0.5, -1}, {0.5, 1});
  scenes::add_create(world, {0, 0, 0, 0});
  scenes::add_create(world, {0, 5, 0, 0});
  Fleet fleet(world);
  const auto report = [&](std::int64_t time, double x) {
    fleet.apply(std::vector<Report>{{.mover = 0, .time = time, .X_WM = {x, 0, 0, 0}, .velocity = {0.5, 0, 0}}});
  };
  report(kTick, 0.2);
  EXPECT_EQ(fleet.predict(kTick)[0].contact_mask, 0u);
  EXPECT_EQ(fleet.contacts()[0], 0);
  EXPECT_NE(fleet.predict(4 * kTick)[0].contact_mask & (sector_bit(0) | sector_bit(-1)), 0u)
      << "extrapolated into the wall";
  EXPECT_EQ(fleet.contacts()[0], 1);
  EXPECT_EQ(fleet.predict(kTick)[0].contact_mask, 0u) << "where it is at that time";
  report(5 * kTick, 0.45);
  EXPECT_NE(fleet.predict(5 * kTick)[0].contact_mask, 0u) << "half way through";
  EXPECT_EQ(fleet.predict(5 * kTick)[1].contact_mask, 0u);
}

TEST(Contact, ReportedContactOfARealBumperIsKept) {
  world::World world = scenes::empty_world();
  scenes::add_create(world, {0, 0, 0, 0});
  Fleet fleet(world);
  fleet.apply(
      std::vector<Report>{{.mover = 0, .time = kTick, .X_WM = {}, .velocity = {}, .contact_mask = sector_bit(3)}});
  EXPECT_EQ(fleet.predict(kTick)[0].contact_mask, sector_bit(3));
  EXPECT_EQ(fleet.contacts()[0], 1);
  scenes::add_wall(world, {0.1655, -1}, {0.1655, 1});
  Fleet both(world);
  both.apply(
      std::vector<Report>{{.mover = 0, .time = kTick, .X_WM = {}, .velocity = {}, .contact_mask = sector_bit(3)}});
  EXPECT_EQ(both.predict(kTick)[0].contact_mask, sector_bit(3) | sector_bit(0) | sector_bit(-1))
      << "in addition to contacts in the virtual world";
}

TEST(Contact, ReportedRobotsTouchEachOther) {
  world::World world = scenes::empty_world();
  scenes::add_square(world, {0, 0, 0, 0});
  scenes::add_square(world, {5, 0, 0, 0});
  Fleet fleet(world);
  fleet.apply(std::vector<Report>{{.mover = 0, .time = kTick, .X_WM = {}},
                                  {.mover = 1, .time = kTick, .X_WM = {0.4, 0, 0, 0}}});
  const auto reports = fleet.predict(kTick);
  EXPECT_NE(reports[0].contact_mask & (sector_bit(0) | sector_bit(-1)), 0u);
  EXPECT_NE(reports[1].contact_mask & (sector_bit(15) | sector_bit(16)), 0u);
}

/// Walls of one model are one touch, at the nearest point. Movers must be near, present, and in the list.
TEST(Contact, TouchesSayWhatAndWhere) {
  world::World world = scenes::empty_world();
  scenes::add_wall(world, {-5.0, 0.5005}, {5.0, 0.5005});
  scenes::add_wall(world, {0.3, 0.5005}, {0.3, 2.0});
  scenes::add_mover(world, {}, scenes::rectangle({}, 2.0, 1.0));                      // its sides: x = +-1, y = +-0.5
  scenes::add_mover(world, {1.1, 0.2, 0.0, 0.0}, scenes::rectangle({}, 0.199, 0.2));  // 0.5 mm apart
  scenes::add_mover(world, {-1.2, 0.0, 0.0, 0.0}, scenes::rectangle({}, 0.2, 0.2));   // 0.1 m apart
  scenes::add_mover(world, {0.0, 0.0, 0.0, 0.0}, scenes::rectangle({}, 0.1, 0.1));    // inside
  Fleet fleet(world);
  const std::vector<std::uint32_t> all{0, 1, 2, 3};
  std::vector<Fleet::Touch> touches;
  fleet.find_touches(0, fleet.reports(), all, touches);
  ASSERT_EQ(touches.size(), 3u);
  EXPECT_EQ(touches[0].mover, world::kNone);
  EXPECT_EQ(touches[0].model, 0u);
  EXPECT_NEAR(touches[0].p.y, 0.5005, 1e-12);
  EXPECT_EQ(touches[1].mover, 1u);
  EXPECT_EQ(touches[1].model, world.movers[1].model);
  EXPECT_NEAR(touches[1].p.x, 1.0005, 1e-12);
  EXPECT_GE(touches[1].p.y, 0.1 - 1e-12);
  EXPECT_LE(touches[1].p.y, 0.3 + 1e-12);
  EXPECT_EQ(touches[2].mover, 3u);
  EXPECT_LE(std::abs(touches[2].p.x), 0.05 + 1e-12);
  touches.clear();
  fleet.set_absent(1, true);
  fleet.find_touches(0, fleet.reports(), std::vector<std::uint32_t>{1}, touches);
  EXPECT_EQ(touches.size(), 1u) << "the wall";
}

}  // namespace
}  // namespace sf::robots
