// Reused readings equal measured ones, and nothing is computed where nothing moves.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <functional>

#include "base/pose.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/cone_scenes.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/units.h"

namespace sf::farm {
namespace {

/// All sensors that depend on poses only, and some with further dependencies, at different rates.
void equip(world::Mover& mover, trial::Chance& chance) {
  const double rates[] = {10.0, 5.0, 13.0};
  const auto with_rate = [&](world::Sensor sensor) {
    sensor.settings.push_back(scenes::setting("rate", {rates[chance.below(3)]}));
    mover.sensors.push_back(std::move(sensor));
  };
  scenes::edit_lasers(mover, [&](auto& laser) { laser.rate = rates[chance.below(3)]; });
  if (chance.below(3) == 0) scenes::edit_laser(mover)->latency = 0.15;
  if (chance.below(4) == 0) scenes::edit_laser(mover)->noise.range_sigma = 0.01;
  if (chance.below(4) == 0) scenes::edit_laser(mover)->resolution = 3;
  constexpr const char* kAccuracies[] = {"", "single", "skip2", "skip4"};
  scenes::edit_laser(mover)->accuracy.word = kAccuracies[chance.below(4)];
  if (chance.below(2) == 0) with_rate(trial::fitted("laneedge", {scenes::setting("range_max", {1.5})}));
  if (chance.below(2) == 0) with_rate(scenes::five());
  if (chance.below(2) == 0 && !mover.sensors.empty() && mover.sensors.back().type == "magnetometer")
    mover.sensors.back().settings.push_back(scenes::text("accuracy", "near1"));
  if (chance.below(2) == 0) with_rate(trial::cones("infrared", trial::ring(4, 0.1)));
  if (chance.below(2) == 0) with_rate(trial::cones("sonar", trial::ring(4, 0.1)));
  if (chance.below(2) == 0)
    with_rate(trial::cones("sonar", trial::ring(4, 0.1), {trial::cone_setting("firing", {}, "all")}));
  if (chance.below(3) == 0) with_rate(trial::fitted("occupancy", {scenes::setting("log_odds", {1.0})}));
  if (chance.below(4) == 0) mover.magnets.push_back(scenes::magnet({0.05, 0.0}, 0.1));
}

world::World varied_world(std::uint64_t seed) {
  trial::Chance chance(seed);
  world::World world = scenes::boxes(8, 10.0, seed);
  world.lane_markings.push_back({{{-4.0, 0.0}, {4.0, 0.3}}, 0.1});
  if (seed % 3 == 1) world.road_resolution = 0.02;
  for (int i = 0; i < 60; ++i) world.magnets.push_back(scenes::magnet(chance.in_square(4.0)));
  if (seed % 2 == 1) world.magnet_cutoff = 1.0;
  scenes::add_robots(world, 14, scenes::laser(kBeams, M_PI, seed % 2 == 0 ? 1.5 : 4.0), seed);
  for (world::Mover& mover : world.movers) equip(mover, chance);
  return world;
}

/// A sequence of states: robots stop, drive and jump in turn; some never move.
class Day {
 public:
  Day(const world::World& world, std::uint64_t seed) : chance_(seed), stir_(world.movers.size()) {
    for (const world::Mover& mover : world.movers) poses_.push_back(mover.X_WM);
  }
  std::vector<base::Report> next() {
    const bool quiet = chance_.below(3) == 0;
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < poses_.size(); ++m) {
      if (chance_.below(6) == 0) stir_[m] = m % 3 != 0 && chance_.below(3) == 0;
      if (stir_[m] && !quiet) step(poses_[m]);
      if (chance_.below(5) != 0) reports.push_back({m, 0, poses_[m], {}});  // a mover without a report stays in place
    }
    return reports;
  }

 private:
  void step(base::Pose& X) {
    if (chance_.below(8) == 0) {
      const glm::dvec2 p = chance_.in_square(4.0);
      X.x = p.x, X.y = p.y;
    }
    X.x += chance_.between(-0.1, 0.1);
    X.yaw += chance_.between(-0.2, 0.2);
  }
  trial::Chance chance_;
  std::vector<base::Pose> poses_;
  std::vector<bool> stir_;
};

void expect_same(const base::ReadingBlock& p, const base::ReadingBlock& q) {
  const auto poses = [](const base::ReadingBlock& r) {
    return std::vector<double>{r.X_WM.x, r.X_WM.y, r.X_WM.z, r.X_WM.yaw, r.X_WS.x, r.X_WS.y, r.X_WS.z, r.X_WS.yaw};
  };
  ASSERT_EQ(p.type, q.type);
  ASSERT_EQ(p.flags, q.flags);
  ASSERT_EQ(p.mode, q.mode);
  ASSERT_EQ(p.bound, q.bound);
  ASSERT_TRUE(std::ranges::equal(p.quality, q.quality));
  ASSERT_EQ(poses(p), poses(q));
  ASSERT_EQ(keep(p).hits, keep(q).hits);
  for (std::size_t i = 0; i < p.values.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint64_t>(p.values[i]), std::bit_cast<std::uint64_t>(q.values[i]))
        << "type " << int{p.type} << " mover " << p.mover << " value " << i << ": " << p.values[i] << ", "
        << q.values[i];
}

void expect_same(std::span<const base::ReadingBlock> p, std::span<const base::ReadingBlock> q) {
  ASSERT_EQ(p.size(), q.size());
  for (std::size_t i = 0; i < p.size() && !testing::Test::HasFatalFailure(); ++i) expect_same(p[i], q[i]);
}

/// @return number of reused readings
std::uint64_t compare(const world::World& world, std::uint64_t seed, int ticks) {
  Farm again(world, device(), {.seed = seed});
  Farm fresh(world, device(), {.seed = seed, .reuse_unchanged = false});
  Day day(world, seed);
  trial::Chance chance(seed + 100);
  for (Farm* farm : {&again, &fresh}) farm->subscribe_all();
  for (int k = 0; k < ticks; ++k) {
    const std::vector<base::Report> reports = day.next();
    const std::uint32_t deaf = chance.below(static_cast<std::uint32_t>(world.movers.size()));
    const base::SensorTypes types = chance.below(4) == 0 ? chance.below(1u << 12) : kAllSensorTypes;
    for (Farm* farm : {&again, &fresh}) farm->subscribe(deaf, types);
    for (std::int64_t due = again.next_due(); due < k * kTick / 2; due = again.next_due()) {
      const std::vector<base::Report> on_the_way = day.next();
      expect_same(again.sample(due, on_the_way), fresh.sample(due, on_the_way));
    }
    expect_same(again.tick(k * kTick / 2, reports), fresh.tick(k * kTick / 2, reports));
    if (testing::Test::HasFatalFailure()) return 0;
  }
  EXPECT_EQ(again.hash(), fresh.hash());
  EXPECT_EQ(fresh.stats().reused, 0u);
  return again.stats().reused;
}

TEST(ReadingCache, ReusedReadingsEqualMeasuredOnes) {
  std::uint64_t again = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    again += compare(varied_world(seed), seed, 60);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(again, 2500u) << "the test is meant to give readings again";
}

/// One robot at rest at the origin, and a disc of 0.165 m radius at given positions.
struct Pair {
  world::World world;
  Farm farm;
  std::int64_t now = 0;

  static world::World made(const std::function<void(world::World&)>& change) {
    world::World world;
    scenes::add_room(world, {}, 20.0);
    scenes::add_robot(world, {}, scenes::laser(kBeams, 2.0 * M_PI, 2.0));
    scenes::add_robot(world, {5.0, 0.0, 0.0, 0.0}, scenes::laser(1));
    scenes::remove_lasers(world.movers[1]);
    if (change) change(world);
    return world;
  }
  explicit Pair(const std::function<void(world::World&)>& change = {})
      : world(made(change)), farm(world, device(), kOnDevice) {
    farm.subscribe(0, kAllSensorTypes);
  }
  /// Returns whether the due reading is reused with the disc at `X`.
  bool again_with(const base::Pose& X, const base::Pose& own = {}) {
    const FarmStats before = farm.stats();
    const std::vector<base::Report> reports{{0, 0, own, {}}, {1, 0, X, {}}};
    const auto readings = farm.tick(std::exchange(now, now + kTick), reports);
    EXPECT_FALSE(readings.empty());
    const std::uint64_t again = farm.stats().reused - before.reused;
    EXPECT_TRUE(again == 0 || again == readings.size()) << "only some";
    EXPECT_EQ(farm.stats().batches - before.batches, again == 0 ? 1u : 0u);
    return again > 0;
  }
  /// Runs ticks until the reading is cached.
  void settle(const base::Pose& X, const base::Pose& own = {}) {
    for (int k = 0; k < 3; ++k) again_with(X, own);
    EXPECT_TRUE(again_with(X, own));
  }
};

TEST(ReadingCache, MeasuresASensorAtRestTwice) {
  Pair pair;
  const base::Pose far{5.0, 0.0, 0.0, 0.0};
  EXPECT_FALSE(pair.again_with(far));
  EXPECT_FALSE(pair.again_with(far)) << "the second reading is stored";
  for (int k = 0; k < 5; ++k) EXPECT_TRUE(pair.again_with(far));
  EXPECT_EQ(pair.farm.stats().work.rays, 2u * kBeams);
}

/// Any change of its own pose counts, even the sign of a zero.
TEST(ReadingCache, MeasuresAMovingSensor) {
  const base::Pose far{5.0, 0.0, 0.0, 0.0};
  for (const base::Pose& own : {base::Pose{1e-300, 0, 0, 0}, base::Pose{0, -1e-9, 0, 0}, base::Pose{0, 0, 0, 1e-16},
                                base::Pose{0, 0, 0, 2.0 * M_PI}, base::Pose{0, 0, 0, -0.0}}) {
    Pair pair;
    pair.settle(far);
    EXPECT_FALSE(pair.again_with(far, own));
    pair.settle(far, own);
  }
}

TEST(ReadingCache, ChecksOldAndNewPositionsOfOthers) {
  const base::Pose far{5.0, 0.0, 0.0, 0.0}, farther{6.0, 0.0, 0.0, 0.0}, near{1.0, 0.0, 0.0, 0.0};
  Pair pair;
  pair.settle(far);
  EXPECT_TRUE(pair.again_with(farther)) << "out of sight";
  EXPECT_FALSE(pair.again_with(near)) << "approaches";
  EXPECT_FALSE(pair.again_with(near)) << "at rest again: stored";
  EXPECT_TRUE(pair.again_with(near)) << "at rest in sight";
  EXPECT_FALSE(pair.again_with({1.0, 0.0, 0.0, 0.1})) << "turns";
  pair.settle({1.0, 0.0, 0.0, 0.1});
  EXPECT_FALSE(pair.again_with(far)) << "leaves";
  pair.settle(far);
  EXPECT_FALSE(pair.again_with({0.1, 2.16, 0.0, 0.0})) << "touches the range with its rim";
  pair.settle(far);
  EXPECT_FALSE(pair.again_with({2.15, 0.1, 0.0, 0.0})) << "on either axis";
  pair.settle(far);
  EXPECT_FALSE(pair.again_with({-2.15, 0.1, 0.0, 0.0})) << "behind it too";
  pair.settle(far);
  EXPECT_TRUE(pair.again_with({0.0, 2.66, 0.0, 0.0})) << "out of range of the sensor at rest";
}

/// The range is measured from the sensor, which may be off its robot's centre.
TEST(ReadingCache, MeasuresRangesFromTheSensor) {
  Pair pair([](world::World& world) { scenes::edit_laser(world.movers[0])->X_MS = {-1.0, 0.0, 0.1, 0.0}; });
  pair.settle({5.0, 0.0, 0.0, 0.0});
  EXPECT_FALSE(pair.again_with({-2.9, 0.0, 0.0, 0.0}));
}

/// Sensors of one type on a robot share the largest radius, so they are invalidated together.
TEST(ReadingCache, UsesTheLargestReachOfARobotsSensors) {
  for (const std::size_t farthest : {0u, 1u}) {
    Pair pair([&](world::World& world) {
      world.movers[0].sensors.push_back(sensors::laser_sensor(sensors::lasers_of(world.movers[0])[0]));
      scenes::edit_laser(world.movers[0], farthest)->range_max = 4.0;
    });
    pair.settle({8.0, 0.0, 0.0, 0.0});
    EXPECT_FALSE(pair.again_with({3.5, 0.0, 0.0, 0.0})) << farthest;
    pair.settle({3.5, 0.0, 0.0, 0.0});
    EXPECT_TRUE(pair.again_with({3.5, 0.0, 0.0, 0.0})) << "and are calm together";
  }
}

/// A mover that appears and disappears between two readings affects none of them, but its motion still invalidates.
TEST(ReadingCache, MotionBetweenReadingsInvalidates) {
  Pair pair([](world::World& world) { scenes::edit_laser(world.movers[0])->rate = 5.0; });
  const std::vector<base::Report> far{{1, 0, {5.0, 0.0, 0.0, 0.0}, {}}}, near{{1, 0, {1.0, 0.0, 0.0, 0.0}, {}}};
  for (int k = 0; k < 6; ++k) pair.farm.tick(k * kTick, far);
  EXPECT_EQ(pair.farm.stats().reused, 1u);
  pair.farm.tick(6 * kTick, far);
  EXPECT_EQ(pair.farm.stats().reused, 2u);
  pair.farm.tick(7 * kTick, near);  // not due
  pair.farm.tick(8 * kTick, near);
  EXPECT_EQ(pair.farm.stats().reused, 2u) << "moved while no sensor was due";
}

TEST(ReadingCache, NeverReusesNoisyReadings) {
  for (const raycast::ScanNoise noise :
       {raycast::ScanNoise{.range_sigma = 0.01}, {.range_proportional = 0.01}, {.angle_sigma = 0.01}}) {
    Pair pair([&](world::World& world) { scenes::edit_laser(world.movers[0])->noise = noise; });
    for (int k = 0; k < 4; ++k) EXPECT_FALSE(pair.again_with({5.0, 0.0, 0.0, 0.0}));
  }
}

TEST(ReadingCache, ReusesReadingsWhenNoiseIsOff) {
  world::World world = small_world(3, {.range_sigma = 0.01});
  Farm farm(world, device(), {.noise = false});
  farm.subscribe_all();
  for (int k = 0; k < 4; ++k) farm.tick(k * kTick, {});
  EXPECT_EQ(farm.stats().reused, 2u * 3u);
}

/// Moving magnets invalidate from any distance; bodies without magnets do not.
TEST(ReadingCache, MagnetometersDependOnlyOnMagnets) {
  for (const bool carries : {false, true}) {
    Pair pair([&](world::World& world) {
      scenes::remove_lasers(world.movers[0]);
      world.movers[0].sensors.push_back(scenes::five());
      world.magnets.push_back(scenes::magnet({0.3, 0.0}));
      world.magnet_cutoff = 0.5;
      if (carries) world.movers[1].magnets.push_back(scenes::magnet({0.0, 0.0}));
    });
    pair.settle({5.0, 0.0, 0.0, 0.0});
    EXPECT_EQ(pair.again_with({5.5, 0.0, 0.0, 0.0}), !carries);
  }
}

/// A robot without an outline is invisible.
TEST(ReadingCache, MoverWithoutOutlineInvalidatesNothing) {
  Pair pair([](world::World& world) { world.movers[1].body.clear(); });
  pair.settle({5.0, 0.0, 0.0, 0.0});
  EXPECT_TRUE(pair.again_with({1.0, 0.0, 0.0, 0.0}));
}

/// A sense request neither reuses nor stores readings.
TEST(ReadingCache, SenseNeitherReusesNorStores) {
  const world::World world = small_world(5);
  Farm asked(world, device()), plain(world, device());
  for (Farm* farm : {&asked, &plain}) farm->subscribe_all();
  const base::Pose elsewhere{0.5, 0.25, 0.0, 1.0};
  std::vector<double> first;
  for (int k = 0; k < 6; ++k) {
    asked.tick(k * kTick, {});
    plain.tick(k * kTick, {});
    const Kept seen = keep(asked.sense(2, 1, 0, elsewhere));
    if (k == 0) first = seen.values;
    EXPECT_EQ(seen.values, first);
  }
  EXPECT_EQ(asked.hash(), plain.hash());
  EXPECT_EQ(asked.stats().reused, plain.stats().reused);
}

/// Moving robots store nothing; robots at rest allocate once.
TEST(ReadingCache, DrivingFleetStoresNothing) {
  const world::World world = small_world(10);
  Farm farm(world, device());
  farm.subscribe_all();
  for (int k = 0; k < 12; ++k) farm.tick(k * kTick, reports_at(world, k));
  EXPECT_EQ(farm.stats().reused, 0u);
}

TEST(ReadingCache, HostSensorsSubmitNothing) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[0])->rate = 1.0;
  scenes::edit_laser(world.movers[1])->rate = 1.0;
  world.movers[0].sensors.push_back(trial::fitted("bumper"));
  Farm farm(world, device(), kOnDevice);
  farm.subscribe_all();
  for (int k = 0; k < 20; ++k) farm.tick(k * kTick, reports_at(world, k));
  EXPECT_EQ(farm.stats().batches, 2u) << "the lasers look once a second";
  EXPECT_EQ(farm.stats().readings, 20u + 2u * 2u);
}

}  // namespace
}  // namespace sf::farm
