// Noise is a distribution of independent draws.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensors/laser_settings.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {
namespace {

constexpr int kNoisyRobots = 8;
constexpr std::uint32_t kBeams = 181;
constexpr int kNoisyTicks = 12;

/// Chi-square of `draws` over 40 bins of equal probability: 39 degrees of freedom, above 72 once in a thousand runs.
double chi_square(const std::vector<double>& draws) {
  std::vector<double> counts(40, 0.0);
  for (const double d : draws)
    counts[std::min<std::size_t>(39, static_cast<std::size_t>(40.0 * 0.5 * std::erfc(-d / std::sqrt(2.0))))] += 1.0;
  const double expected = static_cast<double>(draws.size()) / 40.0;
  double sum = 0.0;
  for (const double count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

double correlation(const std::vector<double>& p, const std::vector<double>& q) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += p[i] * q[i];
  return sum / static_cast<double>(p.size());
}

/// Robots in front of a long slanted wall y = 2 + x / 2, each with two equal sensors.
world::World slanted(const raycast::ScanNoise& noise, double range_max = 30.0) {
  world::World world;
  scenes::add_outline(world, {{-100, -48}, {100, 52}, {100, 60}, {-100, -40}}, "wall");
  sensors::LaserSettings laser = eye(kBeams, 1.0, range_max);
  laser.X_MS.yaw = M_PI / 2 + 0.3;
  laser.noise = noise;
  for (int i = 0; i < kNoisyRobots; ++i) {
    add_eye(world, {0.1 * i, 0.0, 0.0, 0.01 * i}, laser);
    world.movers.back().sensors.push_back(sensors::laser_sensor(laser));
  }
  return world;
}

/// Returns draws by tick, then sensor, then beam, extracted by `of(reading, beam, quiet range)`.
template <class Of>
std::vector<double> draws(const world::World& world, std::uint64_t seed, Of of) {
  farm::Farm noisy(world, device(), {.seed = seed});
  farm::Farm quiet(world, device(), {.noise = false});
  noisy.subscribe_all();
  quiet.subscribe_all();
  std::vector<double> all;
  for (int k = 0; k < kNoisyTicks; ++k) {
    const auto with = noisy.tick(k * 100'000'000ll, {});
    const auto without = quiet.tick(k * 100'000'000ll, {});
    for (std::size_t r = 0; r < with.size(); ++r)
      for (std::uint32_t i = 0; i < kBeams; ++i) all.push_back(of(with[r], i, without[r].values[i]));
  }
  EXPECT_EQ(all.size(), static_cast<std::size_t>(kNoisyTicks * kNoisyRobots * 2) * kBeams);
  return all;
}

void expect_standard_normal(const std::vector<double>& all) {
  EXPECT_LT(ks(all), 1.95);
  EXPECT_LT(chi_square(all), 72.0);
}

/// Expects neighbouring beams, sensors, robots and ticks to be uncorrelated, within 4 standard deviations.
void expect_independent(const std::vector<double>& all) {
  const std::size_t per_tick = static_cast<std::size_t>(kNoisyRobots) * 2 * kBeams;
  for (const std::size_t lag :
       {std::size_t{1}, std::size_t{2}, std::size_t{kBeams}, std::size_t{2 * kBeams}, per_tick}) {
    const std::vector<double> p(all.begin(), all.end() - static_cast<std::ptrdiff_t>(lag));
    const std::vector<double> q(all.begin() + static_cast<std::ptrdiff_t>(lag), all.end());
    EXPECT_LT(std::fabs(correlation(p, q)), 4.0 / std::sqrt(static_cast<double>(p.size()))) << "lag " << lag;
  }
}

TEST(Noise, ConstantRangeNoiseIsNormal) {
  const auto all = draws(slanted({.range_sigma = 0.02}), 1, [](const auto& reading, std::uint32_t i, double quiet) {
    return (reading.values[i] - quiet) / 0.02;
  });
  expect_standard_normal(all);
  expect_independent(all);
}

TEST(Noise, ProportionalRangeNoiseGrowsWithTheRange) {
  const auto all = draws(
      slanted({.range_proportional = 0.01}), 2,
      [](const auto& reading, std::uint32_t i, double quiet) { return (reading.values[i] - quiet) / (0.01 * quiet); });
  expect_standard_normal(all);
}

TEST(Noise, BothPartsAddAsVariances) {
  const auto all = draws(slanted({.range_sigma = 0.02, .range_proportional = 0.01}), 3,
                         [](const auto& reading, std::uint32_t i, double quiet) {
                           return (reading.values[i] - quiet) / std::hypot(0.02, 0.01 * quiet);
                         });
  expect_standard_normal(all);
}

/// Returns the bearing at which the slanted wall is at `range`: r (sin b - cos b / 2) = 2 + x / 2 - y.
double bearing_at(const base::Pose& X_WS, double range) {
  const double gap = (2.0 + 0.5 * X_WS.x - X_WS.y) / std::hypot(1.0, 0.5);
  const double normal = std::atan2(1.0, -0.5);
  return normal + std::acos(gap / range) - X_WS.yaw;  // the scan lies on the left of the wall's normal
}

/// Angular noise turns the beam before the cast: the range is that of the turned beam on the wall.
TEST(Noise, AngularNoiseTurnsTheBeamBeforeItIsCast) {
  world::World world = slanted({.angle_sigma = 0.002});
  for (world::Mover& mover : world.movers)
    scenes::edit_lasers(mover, [](auto& laser) {
      laser.fov = 0.5;
      laser.X_MS.yaw = M_PI / 2 + 0.47 + 0.6;
    });
  const auto all = draws(world, 4, [](const auto& reading, std::uint32_t i, double) {
    const double bearing = -0.25 + 0.5 * i / (kBeams - 1);
    return (bearing_at(reading.X_WS, reading.values[i]) - bearing) / 0.002;
  });
  expect_standard_normal(all);
  expect_independent(all);
}

/// Angles so large that a lane's beams are no longer adjacent: the distribution holds, and ranges are exact.
TEST(Noise, LargeAngularNoise) {
  world::World world = slanted({.angle_sigma = 0.03});
  for (world::Mover& mover : world.movers)
    scenes::edit_lasers(mover, [](auto& laser) {
      laser.fov = 0.1;
      laser.X_MS.yaw = M_PI / 2 + 0.47 + 0.6;
    });
  expect_standard_normal(draws(world, 5, [](const auto& reading, std::uint32_t i, double) {
    const double bearing = -0.05 + 0.1 * i / (kBeams - 1);
    return (bearing_at(reading.X_WS, reading.values[i]) - bearing) / 0.03;
  }));
}

TEST(Noise, MissesHaveNoNoise) {
  world::World world = slanted({.range_sigma = 0.5, .range_proportional = 0.1}, 1.0);
  const Glance glance(world, {.seed = 6});
  for (const auto& reading : glance.readings)
    for (const double range : reading.values) EXPECT_EQ(range, 1.0);
}

TEST(Noise, StaysWithinRangeMinAndRangeMax) {
  world::World world = slanted({.range_sigma = 5.0}, 6.0);
  for (world::Mover& mover : world.movers) scenes::edit_lasers(mover, [](auto& laser) { laser.range_min = 1.5; });
  const Glance glance(world, {.seed = 7});
  std::size_t low = 0, high = 0;
  for (const auto& reading : glance.readings)
    for (const double range : reading.values) {
      ASSERT_GE(range, 1.5);
      ASSERT_LE(range, 6.0);
      low += range == 1.5;
      high += range == 6.0;
    }
  EXPECT_GT(low, 10u);
  EXPECT_GT(high, 10u);
}

TEST(Noise, CanBeDisabled) {
  const world::World world = slanted({.range_sigma = 0.5, .angle_sigma = 0.1});
  const Glance quiet(world, {.noise = false});
  std::vector<base::Pose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(mover.X_WM);
  expect_exact("noise off", compare(world, poses, quiet.readings));
}

TEST(Noise, DependsOnTheSeed) {
  const world::World world = slanted({.range_sigma = 0.02});
  const Glance one(world, {.seed = 1});
  const Glance two(world, {.seed = 2});
  std::size_t same = 0;
  for (std::size_t i = 0; i < kBeams; ++i) same += one.readings[0].values[i] == two.readings[0].values[i];
  EXPECT_EQ(same, 0u);
}

}  // namespace
}  // namespace sf::trial
