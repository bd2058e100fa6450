// Latency: readings are delivered later, unchanged.

#include "farm/delivery.h"

#include <gtest/gtest.h>

#include "tests/farm/small_farm.h"
#include "tests/sensors/edit_laser.h"

namespace sf::farm {
namespace {

constexpr std::int64_t kShortTick = 20'000'000;

TEST(Latency, DeliversReadingsLaterAndUnchanged) {
  world::World prompt = small_world(2);
  scenes::edit_laser(prompt.movers[1])->accuracy.word = "skip2";  // with quality flags of skipped beams
  world::World late = prompt;
  scenes::edit_laser(late.movers[1])->latency = 0.05;
  Farm now(prompt, device());
  Farm later(late, device());
  now.subscribe_all();
  later.subscribe_all();
  std::vector<Kept> expected, delivered;
  for (int k = 0; k < 30; ++k) {
    for (const auto& r : now.tick(k * kShortTick, reports_at(prompt, k)))
      if (r.mover == 1) expected.push_back(keep(r));
    for (const auto& r : later.tick(k * kShortTick, reports_at(late, k))) {
      if (r.mover == 0) {
        EXPECT_EQ(r.time, k * kShortTick) << "no latency: delivered immediately";
        continue;
      }
      delivered.push_back(keep(r));
      EXPECT_GE(k * kShortTick, r.time + 50'000'000) << "not early";
      EXPECT_LT(k * kShortTick, r.time + 50'000'000 + kShortTick) << "in the first tick after";
    }
  }
  ASSERT_EQ(delivered.size(), 6u);
  ASSERT_EQ(expected.size(), 6u);
  EXPECT_FALSE(expected[0].quality.empty());
  EXPECT_EQ(delivered, expected);
}

/// A latency of whole ticks delivers at exactly that tick, a latency below one tick at the next. Boundary: 1 ns more
/// adds a tick.
TEST(Latency, HandlesWholeTicks) {
  const std::int64_t tick = 100'000'000;
  for (const auto& [latency, ticks] : {std::pair{0.1, 1}, {0.2, 2}, {0.100000001, 2}, {0.099999999, 1}, {1e-9, 1}}) {
    world::World world = small_world(1);
    scenes::edit_laser(world.movers[0])->latency = latency;
    Farm farm(world, device());
    farm.subscribe_all();
    for (int k = 0; k < 6; ++k) {
      const auto readings = farm.tick(k * tick, {});
      ASSERT_EQ(readings.size(), k < ticks ? 0u : 1u) << latency << " s, tick " << k;
      EXPECT_TRUE(k < ticks || readings[0].time == (k - ticks) * tick) << latency << " s, tick " << k;
    }
  }
}

/// The other sensors have no latency.
TEST(Latency, AppliesOnlyToTheFirstSensor) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[0])->latency = 0.05;
  Farm farm(world, device());
  farm.subscribe_all();
  const auto readings = farm.tick(0, {});
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].mover, 1u);
}

/// The farm reports the time of the next delivery. A sample at that time, between two ticks, delivers it on time.
TEST(Latency, DeliveredBetweenTicks) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[1])->latency = 0.03;
  scenes::edit_laser(world.movers[1])->rate = 20.0;
  Farm farm(world, device());
  EXPECT_EQ(farm.next_delivery(), kNever);
  farm.subscribe_all();
  EXPECT_EQ(farm.tick(0, {}).size(), 1u);
  EXPECT_EQ(farm.next_delivery(), 30'000'000);
  EXPECT_EQ(farm.sample(29'999'999, {}).size(), 0u) << "a nanosecond early";
  const auto readings = farm.sample(30'000'000, {});
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].time, 0) << "says when it was measured";
  EXPECT_EQ(farm.next_delivery(), kNever);
  EXPECT_EQ(farm.sample(50'000'000, {}).size(), 0u) << "measured, and waits";
  EXPECT_EQ(farm.next_delivery(), 80'000'000);
}

/// Latency above the period: several readings wait at the same time and are delivered in order.
TEST(Latency, MayExceedThePeriod) {
  world::World world = small_world(3);
  for (world::Mover& mover : world.movers) scenes::edit_laser(mover)->latency = 0.35;
  Farm farm(world, device());
  farm.subscribe_all();
  std::uint32_t next[3] = {0, 0, 0};
  for (int k = 0; k < 100; ++k)
    for (const auto& r : farm.tick(k * kShortTick, {})) {
      EXPECT_EQ(r.sequence, next[r.mover]++);
      EXPECT_EQ(r.values.size(), kBeams);
    }
  for (const std::uint32_t count : next) EXPECT_EQ(count, 17u);
}

/// Readings delivered in one tick are ordered by age, oldest first; those without latency come last.
TEST(Latency, DeliversOldestFirst) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[0])->latency = 0.0;
  scenes::edit_laser(world.movers[1])->latency = 0.15;
  Farm farm(world, device());
  farm.subscribe_all();
  farm.tick(0, {});
  farm.tick(100'000'000, {});
  const auto readings = farm.tick(300'000'000, {});
  ASSERT_EQ(readings.size(), 3u);
  EXPECT_EQ(readings[0].time, 0);
  EXPECT_EQ(readings[1].time, 100'000'000);
  EXPECT_EQ(readings[2].mover, 0u);
  EXPECT_EQ(readings[2].time, 300'000'000);
}

/// Readings of one delivery are ordered by robot, not by time of measurement.
TEST(Latency, DeliversRobotByRobot) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[0])->latency = 0.1;
  scenes::edit_laser(world.movers[1])->latency = 0.2;
  Farm farm(world, device());
  farm.subscribe_all();
  farm.tick(0, {});
  farm.tick(100'000'000, {});
  const auto readings = farm.tick(200'000'000, {});
  ASSERT_EQ(readings.size(), 2u);
  EXPECT_EQ(readings[0].mover, 0u);
  EXPECT_EQ(readings[0].time, 100'000'000);
  EXPECT_EQ(readings[1].mover, 1u);
  EXPECT_EQ(readings[1].time, 0);
}

}  // namespace
}  // namespace sf::farm
