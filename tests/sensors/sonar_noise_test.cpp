// Noise of sonar and infrared as a distribution; invariances of readings; allocations of a tick.

#include <gtest/gtest.h>

#include "raycast/casters.h"
#include "sensors/infrared.h"
#include "sensors/sonar.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/scenes.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {
namespace {

using base::Pose;

constexpr int kRings = 8;
constexpr std::size_t kTransducers = 16;
constexpr int kRingTicks = 40;

/// Robots in front of a long slanted wall y = 2 + x / 2, each with two equal rings that face it.
world::World slanted(const world::Sensor& sensor) {
  world::World world;
  scenes::add_outline(world, {{-100, -48}, {100, 52}, {100, 60}, {-100, -40}}, "wall");
  for (int i = 0; i < kRings; ++i) {
    const std::uint32_t m = add_ranger(world, {0.1 * i, 0.0, 0.0, M_PI / 2}, sensor);
    world.movers[m].sensors.push_back(sensor);
  }
  return world;
}

world::Sensor noisy_sonar(double sigma, double proportional) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kTransducers; ++i) poses.push_back({0.0, 0.01 * static_cast<double>(i), 0.0, 0.0});
  return cones("sonar", poses,
               {cone_setting("firing", {}, "all"), cone_setting("range", {0.0, 50.0}),
                cone_setting("noise", {sigma, proportional})});
}

/// Returns draws by tick, then sensor, then transducer, extracted by `of(noisy, quiet)` from first columns.
template <class Of>
std::vector<double> draws(const world::World& world, std::size_t columns, std::int64_t interval, Of of) {
  std::vector<double> all;
  for_noisy_readings(world, 5, kRingTicks, interval, [&](const auto& noisy, const auto& quiet) {
    for (std::size_t i = 0; i < noisy.values.size(); i += columns) all.push_back(of(noisy.values[i], quiet.values[i]));
  });
  EXPECT_EQ(all.size(), kRingTicks * kRings * 2 * kTransducers);
  return all;
}

/// Expects normal draws, uncorrelated between neighbouring transducers, sensors, robots and ticks.
void expect_normal_and_independent(const std::vector<double>& all) {
  EXPECT_LT(ks(all), 1.95);
  expect_uncorrelated(all, {1, 2, kTransducers, 2 * kTransducers, kRings * 2 * kTransducers});
}

/// Noise is added after the choice of the nearest ray, so it does not shorten ranges.
TEST(SonarNoise, IsNormalAndIndependentWithBothPartsAsVariances) {
  for (const double proportional : {0.0, 0.01})
    expect_normal_and_independent(
        draws(slanted(noisy_sonar(0.02, proportional)), 1, 40'000'000,
              [&](double noisy, double quiet) { return (noisy - quiet) / std::hypot(0.02, proportional * quiet); }));
}

TEST(SonarNoise, StaysWithinRangeAndSkipsMissingEchoes) {
  world::World world;
  scenes::add_outline(world, {{1, -50}, {2, -50}, {2, 50}, {1, 50}}, "wall");
  world::Sensor sensor = noisy_sonar(5.0, 0.0);
  sensor.settings[1] = cone_setting("range", {0.5, 2.0});
  sensor.settings.back() = cone_setting("spose3[15]", {0, 0, 0, M_PI});
  add_ranger(world, {}, sensor);
  farm::Farm farm(world, device(), {.seed = 7});
  farm.subscribe_all();
  std::size_t low = 0, high = 0;
  for (int k = 0; k < 20; ++k) {
    const auto readings = farm.tick(k * 40'000'000ll, {});
    EXPECT_EQ(readings[0].values[15], 2.0) << "it looks away";
    for (const double range : readings[0].values.first(15)) {
      ASSERT_GE(range, 0.5);
      ASSERT_LE(range, 2.0);
      low += range == 0.5;
      high += range == 2.0;
    }
  }
  EXPECT_GT(low, 10u);
  EXPECT_GT(high, 10u);
}

/// Transducers that do not fire also keep their draw: their last reading stays the same bit by bit.
TEST(SonarNoise, TransducerThatDoesNotFireKeepsItsReading) {
  world::World world;
  scenes::add_outline(world, {{1, -50}, {2, -50}, {2, 50}, {1, 50}}, "wall");
  add_ranger(world, {}, cones("sonar", std::vector<Pose>(8), {cone_setting("noise", {0.05})}));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  std::vector<double> before;
  for (int k = 0; k < 24; ++k) {
    const auto values = farm.tick(k * 40'000'000ll, {})[0].values;
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_EQ(values[i] == before[i], i != static_cast<std::size_t>(k % 8)) << k << ", " << i;
    before.assign(values.begin(), values.end());
  }
}

/// Webots' table: relative noise of the response grows from 0 at range_min to the setting at range_max.
TEST(InfraredNoise, IsRelativeToTheResponseAndGrowsWithTheRange) {
  world::World world;
  scenes::add_outline(world, {{-100, 0.03}, {100, 0.03}, {100, 1}, {-100, 1}}, "wall");
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < kTransducers; ++i) poses.push_back({0.001 * static_cast<double>(i), 0.0, 0.0, 0.0});
  const world::Sensor sensor = cones("infrared", poses, {cone_setting("noise", {0.04}), cone_setting("rays", {1})});
  for (int i = 0; i < kRings; ++i) {
    const std::uint32_t m = add_ranger(world, {0.1 * i, 0.0, 0.0, M_PI / 2}, sensor);
    world.movers[m].sensors.push_back(sensor);
  }
  const auto all = draws(world, 2, 20'000'000, [](double noisy, double quiet) {
    const double response = 1.0 - quiet / 0.05;
    return (1.0 - noisy / 0.05 - response) / (response * 0.04 * quiet / 0.05);
  });
  expect_normal_and_independent(all);
}

TEST(InfraredNoise, RangeCorrespondsToTheNoisyResponse) {
  world::World world;
  scenes::add_outline(world, {{0.03, -1}, {1, -1}, {1, 1}, {0.03, 1}}, "wall");
  add_ranger(world, {}, cones("infrared", ring(8, 0.001), {cone_setting("noise", {0.2})}));
  farm::Farm farm(world, device(), {.seed = 3});
  farm.subscribe_all();
  std::vector<double> seen;
  for (int k = 0; k < 10; ++k) {
    const auto values = farm.tick(k * 20'000'000ll, {})[0].values;
    EXPECT_EQ(values[1], std::floor(1023.0 * (1.0 - values[0] / 0.05) + 0.5));
    EXPECT_EQ(values[8], 0.05) << "nothing seen, nothing disturbed";
    EXPECT_EQ(values[9], 0.0);
    seen.push_back(values[1]);
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_GT(seen.back() - seen.front(), 20.0);
}

/// A sonar and an infrared sensor with the same number on one robot draw independently.
TEST(InfraredNoise, IsIndependentOfSonarNoise) {
  world::World world;
  scenes::add_outline(world, {{1, -50}, {2, -50}, {2, 50}, {1, 50}}, "wall");
  const std::vector<world::Setting> same{cone_setting("range", {0, 2}), cone_setting("rate", {10})};
  auto sonar = cones("sonar", std::vector<Pose>(8), same), infrared = cones("infrared", std::vector<Pose>(8), same);
  sonar.settings.push_back(cone_setting("noise", {0.01}));
  infrared.settings.push_back(cone_setting("noise", {0.02}));  // at half the range: 0.01 of the response, or 0.01 m
  const std::uint32_t m = add_ranger(world, {}, sonar);
  world.movers[m].sensors.push_back(infrared);
  const Glance run(world, {.seed = 1});
  ASSERT_EQ(run.readings.size(), 2u);
  for (std::size_t i = 0; i < 8; ++i) {
    const double a = run.readings[0].values[i] - 1.0, b = run.readings[1].values[2 * i] - 1.0;
    EXPECT_NE(a, 0.0);
    EXPECT_GT(std::fabs(std::fabs(a) - std::fabs(b)), 1e-9) << i;
  }
}

// --- Invariances of readings.

world::World busy_world(int robots) {
  world::World world = scenes::boxes(40, 16.0, 3);
  Chance chance(9);
  for (int m = 0; m < robots; ++m) {
    const glm::dvec2 p = chance.in_square(7.0);
    const double incidence = m % 2 == 0 ? 0.6 : M_PI / 2;
    const std::uint32_t mover = add_ranger(world, {p.x, p.y, 0.0, chance.between(-9, 9)},
                                           cones("sonar", ring(16, 0.2),
                                                 {cone_setting("arrays", {2}), cone_setting("incidence", {incidence}),
                                                  cone_setting("noise", {0.01, 0.01})}),
                                           0.25);
    world.movers[mover].sensors.push_back(
        cones("infrared", ring(8, 0.2), {cone_setting("range", {0, 0.5}), cone_setting("noise", {0.01})}));
  }
  return world;
}

std::uint64_t hash_of_rings(const world::World& world, const farm::FarmOptions& options) {
  farm::Farm farm(world, device(), options);
  farm.subscribe_all();
  for (int k = 0; k < 12; ++k) farm.tick(k * 40'000'000ll, farm::reports_at(world, k));
  return farm.hash();
}

TEST(SonarHash, DoesNotDependOnThreadsMemoryOrRun) {
  const world::World world = busy_world(40);
  const std::uint64_t one = hash_of_rings(world, {.seed = 4, .threads = 1});
  EXPECT_EQ(hash_of_rings(world, {.seed = 4, .threads = 1}), one);
  EXPECT_EQ(hash_of_rings(world, {.seed = 4, .threads = 2}), one);
  EXPECT_EQ(hash_of_rings(world, {.seed = 4, .threads = 5}), one);
  EXPECT_EQ(hash_of_rings(world, {.seed = 4,
                                  .threads = 2,
                                  .scene = {.caster = &raycast::device_caster, .pool_chunks = 4096, .pool_cells = 64}}),
            one);
  EXPECT_NE(hash_of_rings(world, {.seed = 5, .threads = 2}), one);
}

/// Robots out of range change nothing.
TEST(SonarHash, DoesNotDependOnRobotsOutOfRange) {
  const world::World few = busy_world(6);
  world::World more = few;
  for (int i = 0; i < 5; ++i)
    add_ranger(more, {200.0 + i, 0, 0, 0}, cones("sonar", ring(16, 0.2), {cone_setting("noise", {0.01})}), 0.25);
  farm::Farm a(few, device(), {.seed = 2}), b(more, device(), {.seed = 2});
  a.subscribe_all();
  b.subscribe_all();
  for (int k = 0; k < 10; ++k) {
    const auto one = a.tick(k * 40'000'000ll, {});
    const auto two = b.tick(k * 40'000'000ll, {});
    std::size_t found = 0;
    for (const auto& p : one)
      for (const auto& q : two)
        if (p.mover == q.mover && p.type == q.type) {
          ++found;
          EXPECT_TRUE(std::equal(p.values.begin(), p.values.end(), q.values.begin(), q.values.end()));
        }
    EXPECT_EQ(found, one.size());
  }
}

}  // namespace
}  // namespace sf::trial
