// Robots and linked objects are visible at their reported poses, and never to themselves.

#include <gtest/gtest.h>

#include "sensors/laser_settings.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::Pose;

TEST(Movers, RobotNeverSeesItself) {
  world::World world;
  scenes::add_robot(world, {}, scenes::laser(361, 2.0 * M_PI, 8.0));
  const Glance glance(world);
  for (const std::uint32_t hit : glance.readings[0].hits) EXPECT_EQ(hit, base::kNoHit);
}

TEST(Movers, OtherRobotIsSeenAtItsReportedPose) {
  world::World world;
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t other = scenes::add_robot(world, {50, 0, 0, 0}, eye(1, 0.0, 8.0));
  world.movers[other].is_tag = true;  // a linked object is a mover like any other
  farm::Farm farm(world, device());
  farm.subscribe(0, farm::kAllSensorTypes);
  for (int k = 0; k < 5; ++k) {
    const double x = 1.0 + 0.5 * k;
    const base::Report report{other, 0, {x, 0, 0, M_PI / 8 * k}, {}};
    const auto readings = farm.tick(k * 100'000'000ll, {&report, 1});
    ASSERT_EQ(readings.size(), 1u);
    EXPECT_NEAR(readings[0].values[0], x - 0.165, 1e-12);
    EXPECT_EQ(readings[0].hits[0], world.movers[other].model);
    EXPECT_EQ(readings[0].X_WM.x, 0.0);
  }
  // Without a report it stays there.
  EXPECT_NEAR(farm.tick(500'000'000, {})[0].values[0], 3.0 - 0.165, 1e-12);
}

/// An absent robot is invisible until its next report. The reading is not reused.
TEST(Movers, AbsentRobotIsInvisibleUntilItReturns) {
  world::World world;
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t other = scenes::add_robot(world, {2, 0, 0, 0}, eye(1, 0.0, 8.0));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::int64_t now = 0;
  const auto range = [&](const std::vector<base::Report>& reports) {
    const auto readings = farm.tick(now += 100'000'000, reports);
    EXPECT_EQ(readings.front().mover, 0u);
    return readings.front().values[0];
  };
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(range({}), 1.835, 1e-12);
  farm.set_absent(other, true);
  EXPECT_EQ(range({}), 8.0);
  EXPECT_EQ(range({{other, 0, {1, 0, 0, 0}, {}}}), 8.0) << "whatever its last report was";
  EXPECT_EQ(farm.tick(now += 100'000'000, {}).size(), 1u) << "and it senses nothing";
  farm.set_absent(other, false);
  farm.subscribe(other, farm::kAllSensorTypes);
  EXPECT_NEAR(range({{other, 0, {3, 0, 0, 0}, {}}}), 2.835, 1e-12);
}

/// A single robot, and all others absent.
TEST(Movers, AllOtherRobotsMayBeAbsent) {
  world::World world;
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  for (int i = 0; i < 3; ++i) scenes::add_robot(world, {2.0 + i, 0, 0, 0}, eye(1, 0.0, 8.0));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  for (std::uint32_t m = 1; m < 4; ++m) farm.set_absent(m, true);
  EXPECT_EQ(farm.tick(0, {})[0].values[0], 8.0);
  farm.set_absent(0, true);
  EXPECT_TRUE(farm.tick(100'000'000, {}).empty());
}

/// Boundaries: the body is 0.1 m high, and the beam is at 0.1 m.
TEST(Movers, ReportedHeightsMoveThemInAndOutOfTheBeam) {
  world::World world;
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t other = scenes::add_robot(world, {2, 0, 0, 0}, eye(1, 0.0, 8.0));
  for (world::Segment& s : world.movers[other].body) s.z_min = 0.0, s.z_max = 0.25;
  const double beam = Glance(world).readings[0].X_WS.z;
  farm::Farm farm(world, device());
  farm.subscribe(0, farm::kAllSensorTypes);
  std::int64_t now = 0;
  const auto range = [&](const base::Report& report) {
    return farm.tick(now += 100'000'000, {&report, 1})[0].values[0];
  };
  EXPECT_NEAR(range({other, 0, {3, 0, 0, 0}, {}}), 2.835, 1e-12);
  EXPECT_NEAR(range({other, 0, {3, 0, beam, 0}, {}}), 2.835, 1e-12) << "its lower side is at the beam";
  EXPECT_EQ(range({other, 0, {3, 0, beam + 0.01, 0}, {}}), 8.0) << "above the beam";
  EXPECT_EQ(range({other, 0, {3, 0, beam - 0.25, 0}, {}}), 8.0) << "its upper side is at the beam";
  EXPECT_NEAR(range({other, 0, {3, 0, beam - 0.24, 0}, {}}), 2.835, 1e-12);
  EXPECT_EQ(range({other, 0, {3, 0, 1e7, 0}, {}}), 8.0) << "farther up than any packet states";
  EXPECT_NEAR(range({other, 0, {3, 0, 0, 0}, {}}), 2.835, 1e-12) << "back down";
  EXPECT_EQ(range({0, 0, {0, 0, 0.3, 0}, {}}), 8.0) << "the sensor itself rises";
  EXPECT_NEAR(range({other, 0, {3, 0, 0.3, 0}, {}}), 2.835, 1e-12) << "both are up";
}

TEST(Movers, OnlyEchoingPartsAtTheBeamHeightAreVisible) {
  world::World world;
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  const std::uint32_t other = scenes::add_robot(world, {2, 0, 0, 0}, eye(1, 0.0, 8.0));
  for (world::Segment& s : world.movers[other].body) s.z_max = 0.05;
  EXPECT_EQ(Glance(world).readings[0].values[0], 8.0) << "the beam passes over it";
  world.movers[other].X_WM.z = 0.08;
  EXPECT_NEAR(Glance(world).readings[0].values[0], 1.835, 1e-12) << "raised into the beam";
  for (world::Segment& s : world.movers[other].body) s.seen_by_laser = false;
  EXPECT_EQ(Glance(world).readings[0].values[0], 8.0) << "it does not echo";
}

/// From nearly apart to one inside the other, with sensors inside other robots' bodies.
TEST(Movers, OverlappingRobots) {
  world::World world;
  for (int i = 0; i < 12; ++i)
    scenes::add_robot(world, {0.05 * i * i, 0.01 * i, 0.0, 0.5 * i}, scenes::laser(181, 2.0 * M_PI, 8.0));
  expect_exact("overlapping robots", sweep(world));
}

/// A sensor inside a robot, with a third robot that extends into the same body.
TEST(Movers, SensorInsideARobotSeesAThirdOneExtendingIntoIt) {
  world::World world;
  add_eye(world, {-0.05, 0, 0, 0}, eye(61, 1.0, 8.0));
  scenes::add_robot(world, {}, eye(1, 0.0, 8.0));
  scenes::add_robot(world, {0.2, 0, 0, 0}, eye(1, 0.0, 8.0));
  const Glance glance(world);
  EXPECT_NEAR(glance.readings[0].values[30], 0.2 - 0.165 + 0.05, 1e-9);
  expect_exact("a third robot inside", sweep(world));
}

/// Robots against a wall: touching, a picometre apart, ... and overlapping it.
TEST(Movers, RobotsTouchingAWall) {
  for (const double gap : {0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3, -1e-9, -1e-3}) {
    world::World world;
    scenes::add_outline(world, {{1, -2}, {2, -2}, {2, 2}, {1, 2}}, "wall");
    for (int i = 0; i < 4; ++i)
      scenes::add_robot(world, {1.0 - 0.165 - gap, -1.2 + 0.8 * i, 0.0, 0.0}, eye(1, 0.0, 8.0));
    for (int i = 0; i < 20; ++i) aim(world, {-1.0 + 0.05 * i, -2.0 + 0.21 * i}, {1.0, -0.4}, eye(33, 0.05, 8.0));
    expect_exact("robots touching a wall, gap " + std::to_string(1e9 * gap) + " nm", sweep(world));
  }
}

/// A dense crowd with occlusion and overlaps, near the origin and far from it.
TEST(Movers, DenseCrowd) {
  for (const double far : {0.0, 1e5}) {
    world::World world = scenes::boxes(8, 7.0, 6);
    Chance chance(7);
    for (int i = 0; i < 90; ++i) {
      const glm::dvec2 p = chance.in_square(3.3);
      sensors::LaserSettings laser = scenes::laser(91, i % 3 ? 2.0 * M_PI : 2.0, i % 2 ? 8.0 : 0.75);
      scenes::add_robot(world, {p.x, p.y, 0.0, chance.between(-4.0, 4.0)}, laser);
    }
    world::translate(world, far, -far);
    expect_exact("a dense crowd", sweep(world));
  }
}

/// A moving crowd: every tick is exact, not only the first.
TEST(Movers, EveryTickOfAMovingCrowd) {
  world::World world = scenes::boxes(8, 12.0, 6);
  scenes::add_robots(world, 20, scenes::laser(61, 4.0, 8.0), 3);
  farm::Farm farm(world, device());
  farm.subscribe_all();
  Chance chance(9);
  Tally tally;
  std::vector<Pose> poses = loaded_poses(world);
  for (int k = 0; k < 12; ++k) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < poses.size(); ++m) {
      poses[m].x += chance.between(-0.3, 0.3);
      poses[m].y += chance.between(-0.3, 0.3);
      poses[m].yaw += chance.between(-1.0, 1.0);
      reports.push_back({m, 0, poses[m], {}});
    }
    tally += compare(world, poses, farm.tick(k * 100'000'000ll, reports));
  }
  EXPECT_EQ(tally.beams, 12u * 20u * 61u);
  expect_exact("a moving crowd", tally);
}

/// Long and thin movers that span several direction sectors, with open outlines.
TEST(Movers, LongThinMovers) {
  world::World world;
  Chance chance(11);
  for (int i = 0; i < 10; ++i) {
    const glm::dvec2 p = chance.in_square(3.0);
    const std::uint32_t m = add_eye(world, {p.x, p.y, 0.0, chance.between(-4.0, 4.0)}, eye(181, 2.0 * M_PI, 8.0));
    world::Mover& mover = world.movers[m];
    mover.radius = 1.5;
    world::Segment s;
    s.a = {-1.5, 0.0};
    s.b = {1.5, 0.001};
    s.z_max = 1.0;
    s.solid_left = false;
    s.model = mover.model;
    mover.radius = glm::length(s.b);
    mover.body = {s};
  }
  expect_exact("long thin movers", sweep(world));
}

/// Crowds in which robots at one place see each other from inside: at one pose, rotated, nearly at one pose, in a line
/// along their beams, some inside a large one, and two groups next to each other.
TEST(Movers, CrowdsOfEveryKind) {
  const auto pose = [](int layout, int i, Chance& chance) -> Pose {
    const double x = chance.between(-1.0, 1.0), y = chance.between(-1.0, 1.0);
    switch (layout) {
      case 0:
        return {0.5, 0.25, 0.0, 0.3};
      case 1:
        return {0.5, 0.25, 0.0, 3.0 * x};
      case 2:
        return {0.5 + 1e-9 * x, 0.25 + 1e-9 * y, 0.0, 0.3};
      case 3:
        return {0.5 + 1e-4 * x, 0.25 + 1e-4 * y, 0.0, x};
      case 4:
        return {0.01 * i, 0.0, 0.0, M_PI};
      case 5:
        return {1.5 * x, 1.5 * y, 0.0, 3.0 * x};
      default:
        return {i % 2 == 0 ? 0.0 : 0.34 + 0.01 * x, 0.01 * y, 0.0, i % 2 == 0 ? 0.0 : 3.0};
    }
  };
  for (int layout = 0; layout < 7; ++layout) {
    world::World world;
    scenes::add_room(world, {}, 10.0);
    Chance chance(3);
    for (int i = 0; i < 40; ++i) scenes::add_robot(world, pose(layout, i, chance), scenes::laser(91, 2.0 * M_PI, 8.0));
    if (layout == 5) {
      world::Mover& large = world.movers[0];
      for (world::Segment& s : large.body) s.a = 20.0 * s.a, s.b = 20.0 * s.b;
      large.radius *= 20.0;
    }
    expect_exact("crowd " + std::to_string(layout), sweep(world));
  }
}

}  // namespace
}  // namespace sf::trial
