// Due times of sensors, and their cost.

#include "farm/schedule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/laser.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/edit_laser.h"
#include "tests/units.h"

namespace sf::farm {
namespace {

TEST(Schedule, DueAtPhasePlusWholePeriods) {
  EXPECT_EQ(readings_started(-1, 10.0, 0.0), 0u) << "before time began";
  EXPECT_EQ(readings_started(0, 10.0, 0.0), 1u) << "the first immediately";
  EXPECT_EQ(readings_started(kSecond / 10 - 2, 10.0, 0.0), 1u) << "2 ns early";
  EXPECT_EQ(readings_started(kSecond / 10, 10.0, 0.0), 2u) << "on time";
  EXPECT_EQ(readings_started(kSecond, 10.0, 0.0), 11u);
  EXPECT_EQ(readings_started(kSecond / 4 - 1, 10.0, 0.25), 0u) << "before its phase";
  EXPECT_EQ(readings_started(kSecond / 4, 10.0, 0.25), 1u) << "at its phase";
  EXPECT_EQ(readings_started(100 * kSecond, 0.01, 0.0), 2u) << "slower than a tick a second";
}

/// Reading k starts at phase + k / rate, rounded to a nanosecond, also for odd rates and after a year.
TEST(Schedule, ExactToANanosecondAfterAYear) {
  for (const double rate : {1.0, 10.0, 13.37, 30.0, 37.5, 1.0 / 3.0, 333.3, 1000.0, 1e6})
    for (const double years : {0.0, 0.1, 1.0, 10.0})
      for (int i = 1; i <= 200; ++i) {
        const auto k = static_cast<std::uint64_t>(years * 31'556'952.0 * rate) + static_cast<std::uint64_t>(i);
        const long double due = 1e9L * static_cast<long double>(k) / static_cast<long double>(rate);
        const auto on_time = static_cast<std::int64_t>(std::ceil(due));
        ASSERT_EQ(readings_started(on_time + 1, rate, 0.0), k + 1) << rate << " Hz, reading " << k << " is late";
        ASSERT_EQ(readings_started(on_time - 3, rate, 0.0), k) << rate << " Hz, reading " << k << " is early";
      }
}

TEST(Schedule, CountsEveryReadingOnceForAnyTick) {
  for (const std::int64_t dt : {std::int64_t{1'000'003}, std::int64_t{16'666'667}, std::int64_t{99'999'999}}) {
    std::uint64_t before = 0;
    for (std::int64_t now = 0; now < 20 * kSecond; now += dt) {
      const std::uint64_t begun = readings_started(now, 10.0, 0.03);
      EXPECT_LE(begun, before + 1);
      before = begun;
    }
    EXPECT_EQ(before, 200u) << dt;
  }
}

/// A sensor is due at exactly `due_time`, to the nanosecond, and never before its phase.
TEST(Schedule, DueTimesMatchTheStartOfReadings) {
  EXPECT_EQ(due_time(0, 10.0, 0.0), 0);
  EXPECT_EQ(due_time(0, 10.0, 0.25), kSecond / 4) << "its phase";
  EXPECT_EQ(due_time(3, 10.0, 0.25), kSecond / 4 + 3 * kSecond / 10);
  EXPECT_EQ(due_time(1, 13.0, 0.0), 76'923'077) << "76923076.92 ns";
  EXPECT_EQ(due_time(2, 13.0, 0.0), 153'846'154) << "not twice the rounded period";
  EXPECT_EQ(due_time(1, 3.0, 0.0), 333'333'333) << "rounded down";
  EXPECT_EQ(due_time(1, 1e-12, 0.0), kNever) << "in 30 000 years";
  for (const double rate : {1.0, 10.0, 13.0, 13.37, 30.0, 1.0 / 3.0, 333.3, 1000.0, 1e6})
    for (const double phase : {0.0, 0.01, 1.0 / 3.0})
      for (const double years : {0.0, 1.0, 10.0})
        for (int i = 0; i < 100; ++i) {
          const auto k = static_cast<std::uint64_t>(years * 31'556'952.0 * rate) + static_cast<std::uint64_t>(i);
          const std::int64_t due = due_time(k, rate, phase);
          ASSERT_GE(readings_started(due, rate, phase), k + 1) << rate << " Hz, reading " << k;
          ASSERT_LE(readings_started(due - 2, rate, phase), k) << rate << " Hz, reading " << k;
        }
}

TEST(Schedule, NextDueIsTheEarliestSubscribedSensor) {
  world::World world = small_world(3);
  scenes::edit_laser(world.movers[0])->rate = 50.0;
  scenes::edit_laser(world.movers[1])->rate = 13.0;
  scenes::edit_laser(world.movers[2])->rate = 10.0;
  scenes::edit_laser(world.movers[2])->phase = 0.03;
  Farm farm(world, device());
  EXPECT_EQ(farm.next_due(), kNever) << "no subscriptions";
  farm.subscribe(2, kAllSensorTypes);
  EXPECT_EQ(farm.next_due(), 30'000'000) << "its phase";
  farm.subscribe(1, kAllSensorTypes);
  EXPECT_EQ(farm.next_due(), 0);
  farm.tick(0, {});
  EXPECT_EQ(farm.next_due(), 30'000'000);
  EXPECT_EQ(farm.sample(30'000'000, {}).size(), 1u);
  EXPECT_EQ(farm.next_due(), 76'923'077);
  farm.subscribe(0, 1u << 9);
  EXPECT_EQ(farm.next_due(), 76'923'077) << "another of its types is subscribed";
  farm.subscribe(0, 1u << sensors::kLaser);
  EXPECT_EQ(farm.next_due(), 40'000'000) << "0 and 20 ms went by unheard";
  EXPECT_EQ(farm.stats().missed, 0u);
  EXPECT_EQ(farm.stats().ticks, 1u) << "samples are not ticks";
}

/// Sensors faster than the ticks deliver all readings when the farm samples at their due times; each reading has its
/// own time.
TEST(Schedule, HandlesSensorsFasterThanTheTicks) {
  world::World world = small_world(3);
  const double rates[] = {13.0, 25.0, 50.0};
  for (std::size_t i = 0; i < 3; ++i) scenes::edit_laser(world.movers[i])->rate = rates[i];
  Farm farm(world, device());
  farm.subscribe_all();
  std::vector<std::uint32_t> counts(3);
  const auto look = [&](std::span<const base::ReadingBlock> readings) {
    for (const auto& r : readings) {
      EXPECT_EQ(r.sequence, counts[r.mover]);
      EXPECT_EQ(r.time, due_time(counts[r.mover]++, rates[r.mover], 0.0));
    }
  };
  for (std::int64_t now = 0; now <= 2 * kSecond; now += kSecond / 10) {
    for (std::int64_t due = farm.next_due(); due < now; due = farm.next_due()) look(farm.sample(due, {}));
    look(farm.tick(now, {}));
  }
  EXPECT_EQ(counts, (std::vector<std::uint32_t>{27, 51, 101})) << "in two seconds, both ends included";
  EXPECT_EQ(farm.stats().missed, 0u);
}

/// A tick of a third of a second is early because of rounding: sensors due within a nanosecond are read.
TEST(Schedule, HandlesATickThatIsANanosecondEarly) {
  world::World world = small_world(1);
  scenes::edit_laser(world.movers[0])->rate = 3.0;
  Farm farm(world, device());
  farm.subscribe_all();
  for (std::int64_t k = 0; k < 3; ++k) {
    const auto readings = farm.tick(k * 333'333'333, {});
    ASSERT_EQ(readings.size(), 1u) << k;
    EXPECT_EQ(readings[0].sequence, static_cast<std::uint32_t>(k));
  }
  EXPECT_EQ(farm.next_due(), kSecond);
  EXPECT_TRUE(farm.tick(kSecond - 2, {}).empty()) << "two nanoseconds";
}

/// Without samples between ticks, they give one reading per tick, and the farm counts the missed ones.
TEST(Schedule, CountsMissedReadings) {
  world::World world = small_world(2);
  scenes::edit_laser(world.movers[0])->rate = 50.0;
  Farm farm(world, device());
  farm.subscribe_all();
  for (int k = 0; k <= 10; ++k) EXPECT_EQ(farm.tick(k * kSecond / 10, {}).size(), 2u);
  EXPECT_EQ(farm.stats().missed, 10u * 4u);
  farm.subscribe(0, 0u);
  farm.tick(2 * kSecond, {});
  EXPECT_EQ(farm.stats().missed, 10u * 4u + 9u) << "of subscribed sensors";
}

TEST(Schedule, RatesAndPhasesInAFarm) {
  world::World world = small_world(4);
  scenes::edit_laser(world.movers[0])->rate = 10.0;
  scenes::edit_laser(world.movers[1])->rate = 2.0;
  scenes::edit_laser(world.movers[2])->rate = 10.0;
  scenes::edit_laser(world.movers[2])->phase = 0.05;
  scenes::edit_laser(world.movers[3])->rate = 10.0;  // same rate as the previous one, at another phase
  scenes::edit_laser(world.movers[3])->phase = 0.07;
  Farm farm(world, device());
  farm.subscribe_all();
  std::vector<int> counts(4, 0);
  for (int k = 0; k < 100; ++k)  // 2 s in ticks of 20 ms
    for (const auto& r : farm.tick(k * 20'000'000ll, {})) {
      EXPECT_EQ(r.sequence, static_cast<std::uint32_t>(counts[r.mover]++));
      EXPECT_EQ(r.time, k * 20'000'000ll);
      const double late = 1e-9 * static_cast<double>(r.time) - sensors::lasers_of(world.movers[r.mover])[0].phase -
                          r.sequence / sensors::lasers_of(world.movers[r.mover])[0].rate;
      EXPECT_GE(late, -1e-9);
      EXPECT_LT(late, 0.02);
    }
  EXPECT_EQ(counts, (std::vector<int>{20, 4, 20, 20}));
}

/// A tick longer than the period gives one reading, with the number of the latest due time.
TEST(Schedule, TenSecondTicksAndMicrosecondTicks) {
  const world::World world = small_world(1);
  Farm slow(world, device());
  slow.subscribe_all();
  for (int k = 0; k < 5; ++k) {
    const auto readings = slow.tick(k * 10 * kSecond, {});
    ASSERT_EQ(readings.size(), 1u);
    EXPECT_EQ(readings[0].sequence, 100u * static_cast<std::uint32_t>(k));
  }
  Farm fast(world, device());
  fast.subscribe_all();
  std::size_t readings = 0;
  for (std::int64_t now = 0; now < kSecond / 5; now += 1000) readings += fast.tick(now, {}).size();
  EXPECT_EQ(readings, 2u) << "at 0 and at 0.1 s";
  EXPECT_EQ(fast.stats().ticks, 200'000u);
}

TEST(Schedule, AYearOfSimulatedTime) {
  const world::World world = small_world(1);
  Farm farm(world, device());
  farm.subscribe_all();
  constexpr std::int64_t kDay = 86'400 * kSecond;
  for (int day = 0; day <= 366; ++day) {
    const auto readings = farm.tick(day * kDay, {});
    ASSERT_EQ(readings.size(), 1u) << day;
    EXPECT_EQ(readings[0].sequence, 864'000u * static_cast<std::uint32_t>(day));
  }
}

TEST(Schedule, ComputesNothingForUnsubscribedSensors) {
  const world::World world = small_world(4);
  Farm farm(world, device());
  EXPECT_TRUE(farm.tick(0, {}).empty());
  EXPECT_EQ(farm.stats().work.rays, 0u);
  EXPECT_EQ(farm.stats().work.cells_built, 0u);
  farm.subscribe(2, 1u << 1);
  const auto readings = farm.tick(kSecond / 10, {});
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].mover, 2u);
  EXPECT_EQ(readings[0].sequence, 1u) << "numbered by when it is due: the first was not subscribed";
  EXPECT_EQ(farm.stats().work.rays, kBeams);
  farm.subscribe(2, ~(1u << 1));
  EXPECT_TRUE(farm.tick(kSecond / 5, {}).empty());
  EXPECT_EQ(farm.stats().work.rays, kBeams);
}

}  // namespace
}  // namespace sf::farm
