// Sonar: analytic walls, corners and robots; every cone compared with the nearest of its rays, one by one; firing
// order.

#include "sensors/sonar.h"

#include <gtest/gtest.h>

#include <iostream>

#include "raycast/casters.h"
#include "sensors/cones/rangers.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::ConeArray;

constexpr double kSonarFov = 25.0 * kDegree;

world::Sensor sonar(const std::vector<Pose>& poses, std::vector<world::Setting> more = {}) {
  more.push_back(cone_setting("firing", {}, "all"));
  return cones("sonar", poses, std::move(more));
}

/// Returns the range of one transducer at `X_WM`.
double range_at(world::World world, const Pose& X_WM, std::vector<world::Setting> more = {}) {
  add_ranger(world, X_WM, sonar({Pose{}}, std::move(more)));
  const Glance run(world);
  EXPECT_EQ(run.readings.back().type, sensors::kSonar);
  return run.readings.back().values[0];
}

/// Returns a long wall with its surface at x = `x`, from y = `low` to 50; its end slopes away.
world::World wall_at(double x, double low = -50.0) {
  world::World world;
  scenes::add_outline(world, {{x, low}, {x + 1.0, low + 10.0}, {x + 1.0, 50.0}, {x, 50.0}}, "wall");
  return world;
}

// --- Analytic ranges.

/// Within half a cone of the wall's normal, some ray is close to it: rays are 2.5 degrees apart.
TEST(Sonar, ReadsAWallWithTheRayNearestToItsNormal) {
  for (int k = -40; k <= 40; ++k) {
    const double yaw = k * kDegree;
    double expected = 4.0;
    for (int i = -5; i <= 5; ++i) expected = std::min(expected, 2.0 / std::cos(yaw + i * 0.1 * kSonarFov));
    EXPECT_NEAR(range_at(wall_at(2.0), {0, 0, 0, yaw}), expected, 1e-12) << k << " degrees";
  }
}

TEST(Sonar, ReadsTheNearerWallOfACorner) {
  world::World world = wall_at(1.0);
  scenes::add_outline(world, {{-50, 0.5}, {50, 0.5}, {50, 1.5}, {-50, 1.5}}, "side");
  EXPECT_NEAR(range_at(world, {0, 0, 0, 0}), 1.0, 1e-12) << "along the side wall it is ahead";
  EXPECT_NEAR(range_at(world, {0, 0, 0, M_PI / 2}), 0.5, 1e-12);
  const double edge = 0.25 * M_PI + 0.5 * kSonarFov;  // the outermost ray on the left, facing into the corner
  EXPECT_NEAR(range_at(world, {0, 0, 0, 0.25 * M_PI}), 0.5 / std::sin(edge), 1e-12);
}

/// A wall that begins just within the outermost ray returns an echo, one just outside does not.
TEST(Sonar, ConeEndsAtItsFieldOfView) {
  for (const double fov : {5.0 * kDegree, kSonarFov, 60.0 * kDegree})
    for (const double sign : {-1.0, 1.0}) {
      const double y = 2.0 * std::tan(0.5 * fov);
      const auto look = [&](double from) {
        world::World world = wall_at(2.0, from);
        for (world::Segment& s : world.walls) {
          s.a.y *= sign;
          s.b.y *= sign;
          if (sign < 0.0) std::swap(s.a, s.b);
        }
        return range_at(world, {}, {cone_setting("fov", {fov})});
      };
      EXPECT_NEAR(look(y - 1e-6), 2.0 / std::cos(0.5 * fov), 1e-9) << fov << ", " << sign;
      EXPECT_EQ(look(y + 1e-6), 4.0) << fov << ", " << sign;
    }
}

TEST(Sonar, DetectsSurfacesAtItsHeight) {
  world::World world = wall_at(2.0);
  for (world::Segment& s : world.walls) s.z_max = 0.1;
  EXPECT_EQ(range_at(world, {}), 4.0) << "over it: transducers are 0.1 m up";
  for (world::Segment& s : world.walls) s.z_max = 0.11;
  EXPECT_NEAR(range_at(world, {}), 2.0, 1e-12);
  for (world::Segment& s : world.walls) s.seen_by_laser = false;
  EXPECT_EQ(range_at(world, {}), 4.0) << "what returns nothing";
}

/// A ring inside its robot's own body detects the other robot and never its own.
TEST(Sonar, DetectsOtherRobotsButNotItsOwn) {
  world::World world;
  add_ranger(world, {}, sonar(ring(16, 0.1)), 0.2);
  add_ranger(world, {1.0, 0, 0, 0.3}, sonar(ring(16, 0.1)), 0.2);
  const Glance run(world);
  ASSERT_EQ(run.readings.size(), 2u);
  std::size_t detections = 0;
  for (std::size_t i = 0; i < 16; ++i) detections += run.readings[0].values[i] < 4.0;
  EXPECT_LT(run.readings[0].values[0], 0.75);
  EXPECT_GT(run.readings[0].values[0], 0.69);
  EXPECT_EQ(detections, 3u) << "the transducers that look towards it";
  EXPECT_EQ(run.readings[0].values[8], 4.0);
}

TEST(Sonar, TransducersAreAtTheirPoses) {
  world::World world = wall_at(2.0);
  world::Sensor sensor = sonar({{0.2, 0.1, 0.0, 0.0}, {0.0, 0.3, 0.05, M_PI}, {0.1, 0.0, 0.0, M_PI / 2}});
  sensor.X_MS = {0.1, 0.0, 0.0, M_PI / 2};
  sensor.height = 0.06;
  add_ranger(world, {0.5, 0.0, 0.1, -M_PI / 2}, sensor);
  const Glance run(world);
  const base::ReadingBlock& r = run.readings[0];
  EXPECT_NEAR(r.X_WS.x, 0.5, 1e-15);
  EXPECT_NEAR(r.X_WS.y, -0.1, 1e-15);
  EXPECT_DOUBLE_EQ(r.X_WS.z, 0.13) << "at half the model's height";
  EXPECT_NEAR(r.values[0], 1.3, 1e-12);
  EXPECT_EQ(r.values[1], 4.0) << "it looks back";
  EXPECT_EQ(r.values[2], 4.0) << "it looks along the wall";
}

// --- Ray by ray.

/// Compares the readings of all robots with the reference, for one caster.
ConeTally check(const world::World& world, const std::string& name, const raycast::CasterType* caster) {
  const Glance run(world, {.scene = {.caster = caster}});
  const auto arrays = sensors::cone_arrays_of(world, "sonar", sensors::read_sonar);
  const ConeTally tally = compare_cones(world, loaded_poses(world), run.readings, arrays);
  std::cout << "[ measured ] " << name << ", " << caster->name << ": " << tally.cones << " cones, " << tally.met
            << " met something, worst " << tally.worst << " m, " << tally.wide << " with a ray at a silhouette, "
            << tally.delicate << " too close to the limit to decide\n";
  EXPECT_EQ(tally.wrong, 0u) << name << ": " << tally.example;
  EXPECT_GT(tally.met, tally.cones / 20) << name;
  EXPECT_LT(tally.met, tally.cones) << name;
  EXPECT_LT(tally.wide + tally.delicate, tally.cones / 50) << name;
  EXPECT_LE(tally.worst, 1e-9) << name;
  return tally;
}

/// Checks every caster. @return the tally of the last one
ConeTally check(const world::World& world, const std::string& name) {
  ConeTally tally;
  for (const raycast::CasterType* caster : raycast::casters()) tally = check(world, name, caster);
  return tally;
}

/// Robots among boxes with different cones.
world::World fleet(world::World world, std::uint64_t seed, double incidence = 0.0) {
  Chance chance(seed);
  for (int m = 0; m < 24; ++m) {
    const glm::dvec2 p = chance.in_square(7.0);
    std::vector<Pose> poses;
    for (int i = 0; i < 1 + m % 16; ++i)
      poses.push_back({chance.between(-0.3, 0.3), chance.between(-0.3, 0.3), 0.01 * (i % 3), chance.between(-9, 9)});
    // Up to 30 degrees of 11 rays, four rays share a lane; wider cones have one ray per lane.
    const double rays = m % 5 == 0 ? 1.0 : 2.0 * chance.below(12) + 1.0;
    std::vector<world::Setting> more{cone_setting("fov", {chance.between(0.0, m % 3 == 0 ? 6.0 : 0.6)}),
                                     cone_setting("rays", {rays}),
                                     cone_setting("range", {0.05, chance.between(0.5, 5.0)})};
    if (incidence > 0.0) more.push_back(cone_setting("incidence", {incidence * chance.between(0.2, 1.0)}));
    add_ranger(world, {p.x, p.y, 0.0, chance.between(-9, 9)}, sonar(poses, more), 0.25);
  }
  return world;
}

TEST(Sonar, EveryConeReadsTheNearestOfItsRays) {
  check(fleet(scenes::boxes(60, 16.0, 5), 1), "boxes");
  check(fleet(scenes::cave(500, 16.0, 3), 2), "cave");
}

TEST(Sonar, EveryConeReadsTheNearestOfItsRaysFarFromTheOrigin) {
  world::World world = fleet(scenes::boxes(60, 16.0, 5), 3);
  world::translate(world, 1e5, -1e5);
  check(world, "boxes at 100 km");
}

// --- Flat incidence.

TEST(Sonar, NoEchoFromASmoothWallAtFlatIncidence) {
  const auto one_ray = [](double incidence, double yaw) {
    return range_at(wall_at(2.0), {0, 0, 0, yaw},
                    {cone_setting("incidence", {incidence}), cone_setting("rays", {1.0}), cone_setting("fov", {0.0})});
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_NEAR(one_ray(0.5, sign * 0.4999), 2.0 / std::cos(0.4999), 1e-12) << "just steep enough";
    EXPECT_EQ(one_ray(0.5, sign * 0.5001), 4.0) << "just too flat";
    EXPECT_NEAR(one_ray(M_PI / 2, sign * 0.9), 2.0 / std::cos(0.9), 1e-12) << "off";
  }
}

/// A smooth wall returns an echo while some ray is near its normal. The range is that of this ray.
TEST(Sonar, ConeDetectsASmoothWallWhileItsNormalIsInside) {
  const auto look = [](double degrees) {
    return range_at(wall_at(2.0), {0, 0, 0, degrees * kDegree}, {cone_setting("incidence", {5.0 * kDegree})});
  };
  EXPECT_NEAR(look(17.0), 2.0 / std::cos(4.5 * kDegree), 1e-12);
  EXPECT_EQ(look(18.0), 4.0) << "its outermost ray meets the wall at 5.5 degrees";
}

/// A surface without an echo still occludes: sound reflected off a smooth wall is lost, and the ray does not continue
/// behind it.
TEST(Sonar, SmoothWallOccludes) {
  world::World world = wall_at(3.0);
  scenes::add_outline(world, {{1.0, 0.9}, {1.0, -1.1}, {2.0, 0.0}, {2.0, 0.4}}, "wedge");
  const double straight =
      range_at(world, {}, {cone_setting("incidence", {1.0 * kDegree}), cone_setting("rays", {1.0})});
  EXPECT_NEAR(straight, 1.0, 1e-12);
  const double flat = range_at(world, {0, 0, 0, 0.2}, {cone_setting("incidence", {0.1}), cone_setting("rays", {1.0})});
  EXPECT_EQ(flat, 4.0);
}

TEST(Sonar, SmoothSidesRotateWithTheirRobot) {
  for (const double yaw : {0.0, M_PI / 2, 0.3, 2.0}) {
    world::World world;
    add_ranger(world, {}, sonar({Pose{}}, {cone_setting("incidence", {0.05}), cone_setting("rays", {1.0})}));
    const std::uint32_t other = add_eye(world, {2.0, 0.0, 0.0, yaw}, {});
    scenes::remove_lasers(world.movers[other]);
    const glm::dvec2 corners[] = {{-0.3, -0.3}, {0.3, -0.3}, {0.3, 0.3}, {-0.3, 0.3}};
    for (int i = 0; i < 4; ++i) {
      world::Segment side;
      side.a = corners[i];
      side.b = corners[(i + 1) % 4];
      side.z_max = 1.0;
      side.model = world.movers[other].model;
      world.movers[other].body.push_back(side);
    }
    world.movers[other].radius = 0.5;
    const Glance run(world);
    if (yaw == 0.0 || yaw == M_PI / 2)
      EXPECT_NEAR(run.readings[0].values[0], 1.7, 1e-12) << "square to it: " << yaw;
    else
      EXPECT_EQ(run.readings[0].values[0], 4.0) << yaw;
  }
}

TEST(Sonar, EveryConeReadsTheNearestSteepHit) {
  check(fleet(scenes::boxes(60, 16.0, 5), 4, 1.2), "smooth boxes");
  check(fleet(scenes::cave(500, 16.0, 3), 5, 1.2), "smooth cave");
}

/// Surfaces without an echo for one sensor may return an echo to another in the same world.
TEST(Sonar, SensorsWithDifferentIncidenceLimitsShareAWorld) {
  world::World world = wall_at(2.0);
  const auto one_ray = [](double incidence) {
    return cones("sonar", {Pose{}},
                 {cone_setting("incidence", {incidence}), cone_setting("rays", {1.0}), cone_setting("fov", {0.0}),
                  cone_setting("range", {0.0, 4.0})});
  };
  for (const double incidence : {0.3, M_PI / 2, 0.3, 0.7}) add_ranger(world, {0, 0, 0, 0.5}, one_ray(incidence));
  const Glance run(world);
  const double steep = 2.0 / std::cos(0.5);
  EXPECT_EQ(run.readings[0].values[0], 4.0);
  EXPECT_NEAR(run.readings[1].values[0], steep, 1e-12);
  EXPECT_EQ(run.readings[2].values[0], 4.0);
  EXPECT_NEAR(run.readings[3].values[0], steep, 1e-12);
}

/// A robot passes rings at rest, some of them with a firing cycle, and stops: reused and measured readings have equal
/// bytes.
TEST(Sonar, ReusedReadingsEqualMeasuredOnes) {
  world::World world = scenes::boxes(20, 8.0, 2);
  const auto passer = add_ranger(world, {}, cones("sonar", ring(4, 0.15)), 0.2);
  for (int i = 0; i < 6; ++i)
    add_ranger(world, {0.5 * i - 1.2, 0.6, 0.0, 0.4 * i},
               cones("sonar", ring(8, 0.15), {cone_setting("arrays", {i % 2 == 0 ? 2.0 : 8.0})}), 0.16);
  farm::Farm reusing(world, device()), measuring(world, device(), {.reuse_unchanged = false});
  reusing.subscribe_all();
  measuring.subscribe_all();
  for (int k = 0; k < 90; ++k) {
    const double x = k < 40 ? -3.0 : std::min(3.0, 0.2 * (k - 55));
    const base::Report report{passer, 0, {x, 0.1, 0.0, 0.0}, {}};
    reusing.tick(k * 40'000'000ll, {&report, 1});
    measuring.tick(k * 40'000'000ll, {&report, 1});
    ASSERT_EQ(reusing.hash(), measuring.hash()) << "tick " << k;
  }
  EXPECT_GT(reusing.stats().reused, 0u);
}

// --- Firing order.

TEST(Sonar, FiringCycleRepeats) {
  using sensors::has_fired;
  constexpr std::uint64_t kNever = ~std::uint64_t{0};
  for (std::uint32_t i = 0; i < 8; ++i) {
    EXPECT_TRUE(has_fired(i, 8, 0, kNever)) << "the first reading is whole";
    EXPECT_TRUE(has_fired(i, 8, 123, kNever));
    EXPECT_EQ(has_fired(i, 8, 9, 8), i == 1);
    EXPECT_EQ(has_fired(i + 8, 8, 9, 8), i == 1) << "the second array fires with the first";
    EXPECT_EQ(has_fired(i, 8, 18, 15), i < 3) << "0, 1 and 2 had their turns";
    EXPECT_EQ(has_fired(i, 8, 17, 14), i == 7 || i < 2);
    EXPECT_TRUE(has_fired(i, 8, 20, 12)) << "a round ago";
    EXPECT_EQ(has_fired(i, 8, 20, 13), i != 5) << "a round but one ago: reading 13 updated it";
    EXPECT_TRUE(has_fired(i, 8, 5, 5)) << "asked again";
    EXPECT_TRUE(has_fired(i, 8, 3, 5)) << "time went back";
    EXPECT_TRUE(has_fired(i, 1, 6, 5)) << "all at once";
  }
}

std::vector<base::Report> report_at(double x) { return {{0, 0, Pose{x, 0, 0, 0}, {}}}; }

/// Two arrays of four around a robot that moves a centimetre per reading: a transducer's range is that of its firing.
TEST(Sonar, OneTransducerOfEachArrayFiresPerReading) {
  world::World world = wall_at(3.0);
  add_ranger(world, {}, cones("sonar", std::vector<Pose>(8), {cone_setting("arrays", {2.0})}));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<double> expected(8);
  for (int k = 0; k < 30; ++k) {
    const double x = 0.01 * k;
    const auto readings = farm.tick(k * 40'000'000ll, report_at(x));
    ASSERT_EQ(readings.size(), 1u) << "25 Hz";
    for (int i = 0; i < 8; ++i) {
      if (k == 0 || i % 4 == k % 4) expected[static_cast<std::size_t>(i)] = 3.0 - x;
      EXPECT_NEAR(readings[0].values[static_cast<std::size_t>(i)], expected[static_cast<std::size_t>(i)], 1e-12)
          << "reading " << k << ", transducer " << i;
    }
  }
  EXPECT_EQ(farm.stats().work.rays, (8u + 29u * 2u) * 11u);
}

/// In a farm with ticks slower than the firing, each tick updates all transducers that have fired since the last tick.
TEST(Sonar, SlowTicksSkipNoTurn) {
  world::World world = wall_at(3.0);
  add_ranger(world, {}, cones("sonar", std::vector<Pose>(8)));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<double> fired(8, 0.0);
  for (int k = 0; k < 12; ++k) {
    const std::int64_t now = k * 100'000'000ll;
    const double x = 0.01 * k;
    const auto readings = farm.tick(now, report_at(x));
    ASSERT_EQ(readings.size(), 1u);
    const auto begun = static_cast<std::uint32_t>(2.5 * k);  // readings 0, 2, 5, 7, 10, ...
    EXPECT_EQ(readings[0].sequence, begun);
    for (std::uint32_t turn = k == 0 ? 0 : static_cast<std::uint32_t>(2.5 * (k - 1)) + 1; turn <= begun; ++turn)
      fired[turn % 8] = x;
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(readings[0].values[i], 3.0 - fired[i], 1e-12) << k << ", " << i;
  }
}

TEST(Sonar, AllTransducersUpdateAfterAPause) {
  world::World world = wall_at(3.0);
  add_ranger(world, {}, cones("sonar", std::vector<Pose>(8)));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  farm.tick(0, report_at(0.0));
  farm.subscribe(0, 0u);
  for (int k = 1; k < 20; ++k) EXPECT_TRUE(farm.tick(k * 40'000'000ll, report_at(1.0)).empty());
  farm.subscribe_all();
  const auto readings = farm.tick(20 * 40'000'000ll, report_at(1.0));
  for (const double range : readings[0].values) EXPECT_NEAR(range, 2.0, 1e-12);
  for (const double range : farm.sense(0, sensors::kSonar, 0, {1.5, 0, 0, 0}).values) EXPECT_NEAR(range, 1.5, 1e-12);
}

/// Tables are written even when nothing is due: nothing in the first tick, some sensors later.
TEST(Sonar, SomeSensorsAreDueAndSomeAreNot) {
  world::World world = wall_at(3.0);
  for (int m = 0; m < 200; ++m) {
    world::Sensor sensor = sonar({Pose{}}, {cone_setting("rate", {m % 2 == 0 ? 10.0 : 5.0})});
    sensor.settings.push_back(cone_setting("phase", {0.1}));
    add_ranger(world, {0.01 * m, 0, 0, 0}, sensor);
  }
  farm::Farm farm(world, device());
  farm.subscribe_all();
  for (const std::size_t due : {0u, 200u, 100u, 200u, 100u}) {
    static std::int64_t now = 0;
    const auto readings = farm.tick(now, {});
    now += 100'000'000;
    ASSERT_EQ(readings.size(), due);
    for (const auto& r : readings) EXPECT_NEAR(r.values[0], 3.0 - 0.01 * r.mover, 1e-12);
  }
}

}  // namespace
}  // namespace sf::trial
