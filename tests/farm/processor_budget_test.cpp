// Budgets of processor time: priorities, fairness among equals, learnt costs, and notices of everything dropped.

#include "farm/processor_budget.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <functional>
#include <map>

#include "base/time.h"
#include "farm/farm.h"
#include "sensors/encoder.h"
#include "sensors/gyro.h"
#include "sensors/laser.h"
#include "sensors/localization.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "world/stage/build_world.h"

namespace sf::farm {
namespace {

constexpr std::int64_t kTick = 100'000'000;  // [ns]

world::World crowd(int robots, const std::string& sensors) {
  std::string text = "define bot position( size [0.3 0.3 0.1] " + sensors + " )\n";
  for (int k = 0; k < robots; ++k)
    text += "bot( name \"r" + std::to_string(k) + "\" pose [" + std::to_string(2 * k) + " 0 0 0] )\n";
  return world::build_world("crowd.world", text, {.sensors = sensors::world_file_words()});
}

using Counts = std::map<std::pair<std::uint32_t, std::uint8_t>, int>;  // by mover and type

/// The due times of a world's sensors, each element of which costs `per_element` [s].
struct Trial {
  Trial(const world::World& w, double budget, double per_element)
      : world(w),
        sensor_set(world),
        nodes(sensors::wire(world, sensor_set)),
        states(world.movers.size()),
        subscribed(world.movers.size(), kAllSensorTypes),
        cost(per_element),
        processor(budget, 2e-9 * kTick * budget, nodes) {
    const sensors::SensorContext context{world, host_device(), pool, states, 1, true, true, {}};
    for (const auto& group : sensor_set.groups()) pipelines.emplace_back(context, group, false);
    for (SensorPipeline& pipeline : pipelines) all.push_back(&pipeline);
  }
  /// Returns how often each sensor was measured in some ticks.
  Counts run(int ticks) {
    Counts measured;
    for (int k = 0; k < ticks; ++k, ++tick) {
      for (SensorPipeline& pipeline : pipelines) pipeline.find_due(tick * kTick, subscribed);
      processor.admit(tick * kTick, all);
      double elements = 0.0;
      for (const SensorPipeline& pipeline : pipelines)
        for (const sensors::DueSample& due : pipeline.due) {
          const sensors::SensorSpec& row = pipeline.group->rows[due.row];
          ++measured[{row.mover, pipeline.group->type->id}];
          elements += row.elements;
        }
      processor.spent(cost * elements * factor(tick));
      used += cost * elements * factor(tick);
      dropped += processor.dropped().size();
    }
    return measured;
  }
  world::World world;
  sensors::SensorSet sensor_set;
  std::vector<sensors::DerivedNode> nodes;
  base::ThreadPool pool{1};
  std::vector<base::Report> states;
  std::vector<base::SensorTypes> subscribed;
  std::vector<SensorPipeline> pipelines;
  std::vector<SensorPipeline*> all;
  double cost;
  ProcessorBudget processor;
  std::int64_t tick = 0;
  std::size_t dropped = 0;
  std::function<double(std::int64_t tick)> factor = [](std::int64_t) { return 1.0; };  ///< of the cost
  double used = 0.0;                                                                   ///< [s]
};

TEST(TokenBucket, FillsToItsLimit) {
  TokenBucket bucket(10.0, 2.0);
  EXPECT_TRUE(bucket.has(2.0)) << "full at first";
  EXPECT_FALSE(bucket.has(2.1));
  bucket.spend(100.0);
  EXPECT_FALSE(bucket.has(0.01));
  bucket.refill(100'000'000);
  EXPECT_TRUE(bucket.has(0.999));
  EXPECT_FALSE(bucket.has(1.001));
  bucket.refill(base::nanoseconds(1000.0));
  EXPECT_FALSE(bucket.has(2.1)) << "its limit";
  bucket.spend(-5.0);
  EXPECT_FALSE(bucket.has(2.1)) << "nor by giving back";
}

TEST(TokenBucket, WhatItLacksIsOwed) {
  TokenBucket bucket(10.0, 2.0);
  bucket.charge(3.0, 2.0);  // owes 1
  bucket.refill(base::nanoseconds(0.15));
  EXPECT_TRUE(bucket.has(1.5)) << "until it is settled";
  bucket.settle();
  EXPECT_TRUE(bucket.has(0.5));
  EXPECT_FALSE(bucket.has(0.51));
  bucket.charge(3.5, 2.0);  // owes 2 of 3
  bucket.refill(base::nanoseconds(0.25));
  EXPECT_TRUE(bucket.has(0.0));
  EXPECT_FALSE(bucket.has(0.01)) << "the level was -1";
  bucket.charge(1e9, 2.0);
  bucket.refill(base::nanoseconds(10.24));
  EXPECT_FALSE(bucket.has(0.0)) << "the level was that of 50 buckets";
  bucket.refill(base::nanoseconds(10.45));
  EXPECT_TRUE(bucket.has(2.0));
  bucket.settle();
  EXPECT_FALSE(bucket.has(0.01));
}

constexpr double kPerElement = 1e-5;  // [s]

/// Ten lasers and gyros, first with as much time as they need, then with half of it.
TEST(ProcessorBudget, ALoadThatDoublesLeavesHighPrioritiesAlone) {
  const std::string sensors = "laser( samples 100 rate 10 ) gyro( rate 10 priority 9 )";
  const double full = 10.0 * 10.0 * 101.0 * kPerElement;  // [s] per second of run
  Trial enough(crowd(10, sensors), 1.2 * full, kPerElement);
  enough.run(100);
  EXPECT_EQ(enough.dropped, 0u);

  Trial half(crowd(10, sensors), 0.5 * full, kPerElement);
  half.run(100);  // learns the costs
  EXPECT_NEAR(half.processor.cost(sensors::kLaser), kPerElement, 0.1 * kPerElement);
  half.dropped = 0;
  const Counts measured = half.run(200);
  std::size_t sum = 0;
  for (std::uint32_t m = 0; m < 10; ++m) {
    EXPECT_EQ(measured.at({m, sensors::kGyro}), 200) << "a high priority";
    EXPECT_NEAR(measured.at({m, sensors::kLaser}), 100, 10) << "equals take turns";
    sum += static_cast<std::size_t>(measured.at({m, sensors::kLaser}));
  }
  EXPECT_EQ(half.dropped, 2000 - sum) << "everything that is dropped is stated";
}

/// Every eighth tick takes 4.5 times as long, the others half as long: the mean is the same.
TEST(ProcessorBudget, SlowTicksArePaidByLowPriorities) {
  const double full = 10.0 * 10.0 * 101.0 * kPerElement;  // [s] per second of run
  Trial trial(crowd(10, "laser( samples 100 rate 10 ) gyro( rate 10 priority 9 )"), 0.5 * full, kPerElement);
  trial.factor = [](std::int64_t tick) { return tick % 8 == 0 ? 4.5 : 0.5; };
  trial.run(200);
  trial.used = 0.0;
  const Counts measured = trial.run(400);
  EXPECT_LE(trial.used / 40.0, 0.51 * full) << "charged to the next ticks";
  EXPECT_GE(trial.used / 40.0, 0.4 * full);
  for (std::uint32_t m = 0; m < 10; ++m) EXPECT_EQ(measured.at({m, sensors::kGyro}), 400);
}

/// Without lower priorities, all share the debt.
TEST(ProcessorBudget, SlowTicksOfEqualsArePaidByAll) {
  const double full = 10.0 * 10.0 * 100.0 * kPerElement;
  Trial trial(crowd(10, "laser( samples 100 rate 10 )"), 0.5 * full, kPerElement);
  trial.factor = [](std::int64_t tick) { return tick % 8 == 0 ? 4.5 : 0.5; };
  trial.run(200);
  trial.used = 0.0;
  trial.run(400);
  EXPECT_NEAR(trial.used / 40.0, 0.5 * full, 0.02 * full);
}

TEST(ProcessorBudget, InputsHaveThePriorityOfTheirConsumers) {
  const std::string sensors =
      "laser( samples 100 rate 10 priority 5 ) encoder( rate 10 priority 0 )\n"
      "derived( type \"localization\" inputs [\"encoder\"] rate 10 priority 8 )";
  Trial trial(crowd(4, sensors), 20.0 * 8.0 * kPerElement, kPerElement);  // encoders, localizations and as much again
  trial.run(100);
  const Counts measured = trial.run(100);
  int lasers = 0;
  for (std::uint32_t m = 0; m < 4; ++m) {
    EXPECT_EQ(measured.at({m, sensors::kEncoder}), 100);
    EXPECT_EQ(measured.at({m, sensors::kLocalization}), 100);
    const auto laser = measured.find({m, sensors::kLaser});
    lasers += laser == measured.end() ? 0 : laser->second;
  }
  EXPECT_LT(lasers, 8) << "too expensive, so only tried";
}

/// Boundary: a high priority that costs more than the bucket holds does not keep the others from being measured.
TEST(ProcessorBudget, AReadingThatIsTooExpensiveStopsNoOther) {
  Trial trial(crowd(2, "laser( samples 200 rate 10 priority 9 ) gyro( rate 10 priority 0 )"), 10.0 * 8.0 * kPerElement,
              kPerElement);
  trial.run(200);
  const Counts measured = trial.run(200);
  for (std::uint32_t m = 0; m < 2; ++m) {
    EXPECT_GE(measured.at({m, sensors::kGyro}), 190);
    const auto laser = measured.find({m, sensors::kLaser});
    EXPECT_LT(laser == measured.end() ? 0 : laser->second, 10);
  }
}

/// The processor time that is used does not exceed the budget in the mean, whatever the load.
RC_GTEST_PROP(ProcessorBudget, HoldsInTheMean, ()) {
  const int robots = *rc::gen::inRange(1, 20), beams = *rc::gen::inRange(1, 300);
  const double share = 0.01 * *rc::gen::inRange(5, 300);
  const double full = 10.0 * robots * beams * kPerElement, budget = share * full;
  Trial trial(crowd(robots, "laser( samples " + std::to_string(beams) + " rate 10 )"), budget, kPerElement);
  trial.run(200);
  int measured = 0;
  for (const auto& [key, count] : trial.run(400)) measured += count;
  const double used = measured * beams * kPerElement / 40.0;
  RC_ASSERT(used <= std::min(full, budget) * 1.1 + 4.0 * beams * kPerElement / 40.0);
  if (share > 1.1) RC_ASSERT(measured == 400 * robots);
}

/// Each call costs the same by this clock: twice the budget.
TEST(ProcessorBudget, DroppedReadingsAreNeverDelivered) {
  const world::World world = crowd(4, "gyro( rate 10 priority 9 ) laser( samples 10 rate 10 latency 0.2 )");
  double clock = 0.0;
  Farm farm(world, device(),
            {.threads = 1, .processor_budget = 0.01, .processor_clock = [&clock] { return clock += 0.02; }});
  farm.subscribe_all();
  std::size_t lasers = 0, gyros = 0, dropped = 0;
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    for (const base::ReadingBlock& reading : farm.tick(tick * kTick, {})) {
      (reading.type == sensors::kLaser ? lasers : gyros) += 1;
      EXPECT_EQ(reading.time, (tick - (reading.type == sensors::kLaser ? 2 : 0)) * kTick);
    }
    for (const DroppedReading& reading : farm.dropped()) dropped += reading.type == sensors::kLaser;
  }
  EXPECT_GT(dropped, 100u);
  EXPECT_NEAR(static_cast<double>(lasers + dropped), 4 * 199, 5) << "each is delivered late or dropped";
  EXPECT_EQ(farm.stats().dropped, 4 * 200 - gyros + dropped);
}

TEST(ProcessorBudget, PrioritiesAreZeroToNine) {
  const auto refused = [](const std::string& priority) {
    return refusal_of([&] { sensors::SensorSet(crowd(1, "laser( priority " + priority + " )")); });
  };
  EXPECT_EQ(refused("9"), "");
  expect_in("'priority'", refused("10"));
  expect_in("'priority'", refused("-1"));
  expect_in("'priority'", refused("2.5"));
}

}  // namespace
}  // namespace sf::farm
