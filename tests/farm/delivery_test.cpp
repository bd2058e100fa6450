// Latency: measured now, delivered later, unchanged.

#include "farm/delivery.h"

#include <gtest/gtest.h>

#include "tests/farm/small_farm.h"

namespace sf::farm {
namespace {

constexpr std::int64_t kTick = 20'000'000;

TEST(Latency, AReadingComesLaterAndUnchanged) {
  const world::World prompt = small_world(2);
  world::World late = prompt;
  late.movers[1].lasers[0].latency = 0.05;
  Farm now(prompt, device());
  Farm later(late, device());
  now.hear_all();
  later.hear_all();
  std::vector<Kept> expected, delivered;
  for (int k = 0; k < 30; ++k) {
    for (const auto& r : now.tick(k * kTick, reports_at(prompt, k)))
      if (r.mover == 1) expected.push_back(keep(r));
    for (const auto& r : later.tick(k * kTick, reports_at(late, k))) {
      if (r.mover == 0) {
        EXPECT_EQ(r.time, k * kTick) << "no latency: at once";
        continue;
      }
      delivered.push_back(keep(r));
      EXPECT_GE(k * kTick, r.time + 50'000'000) << "not early";
      EXPECT_LT(k * kTick, r.time + 50'000'000 + kTick) << "in the first tick after";
    }
  }
  ASSERT_EQ(delivered.size(), 6u);
  ASSERT_EQ(expected.size(), 6u);
  EXPECT_EQ(delivered, expected);
}

/// Longer than the period: several wait at once, and come in order.
TEST(Latency, LongerThanThePeriod) {
  world::World world = small_world(3);
  for (world::Mover& mover : world.movers) mover.lasers[0].latency = 0.35;
  Farm farm(world, device());
  farm.hear_all();
  std::uint32_t next[3] = {0, 0, 0};
  for (int k = 0; k < 100; ++k)
    for (const auto& r : farm.tick(k * kTick, {})) {
      EXPECT_EQ(r.sequence, next[r.mover]++);
      EXPECT_EQ(r.values.size(), kBeams);
    }
  for (const std::uint32_t count : next) EXPECT_EQ(count, 17u);
}

/// Readings that become due in one tick come oldest first, those without latency last.
TEST(Latency, OldestFirst) {
  world::World world = small_world(2);
  world.movers[0].lasers[0].latency = 0.0;
  world.movers[1].lasers[0].latency = 0.15;
  Farm farm(world, device());
  farm.hear_all();
  farm.tick(0, {});
  farm.tick(100'000'000, {});
  const auto readings = farm.tick(300'000'000, {});
  ASSERT_EQ(readings.size(), 3u);
  EXPECT_EQ(readings[0].time, 0);
  EXPECT_EQ(readings[1].time, 100'000'000);
  EXPECT_EQ(readings[2].mover, 0u);
  EXPECT_EQ(readings[2].time, 300'000'000);
}

}  // namespace
}  // namespace sf::farm
