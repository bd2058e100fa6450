// Noise is a distribution of independent draws.

#include <fmt/core.h>
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
  std::vector<double> all;
  for_noisy_readings(world, seed, kNoisyTicks, 100'000'000, [&](const auto& noisy, const auto& quiet) {
    for (std::uint32_t i = 0; i < kBeams; ++i) all.push_back(of(noisy, i, quiet.values[i]));
  });
  EXPECT_EQ(all.size(), static_cast<std::size_t>(kNoisyTicks * kNoisyRobots * 2) * kBeams);
  return all;
}

void expect_standard_normal(const std::vector<double>& all) {
  EXPECT_LT(ks(all), 1.95);
  EXPECT_LT(chi_square(all), 72.0);
}

/// Expects neighbouring beams, sensors, robots and ticks to be uncorrelated.
void expect_independent(const std::vector<double>& all) {
  expect_uncorrelated(all, {1, 2, kBeams, 2 * kBeams, kNoisyRobots * 2 * kBeams});
}

TEST(Noise, RangeNoiseIsNormalWithConstantAndProportionalPartsAsVariances) {
  for (const raycast::ScanNoise& noise :
       {raycast::ScanNoise{.range_sigma = 0.02}, raycast::ScanNoise{.range_proportional = 0.01},
        raycast::ScanNoise{.range_sigma = 0.02, .range_proportional = 0.01}}) {
    SCOPED_TRACE(fmt::format("constant {}, proportional {}", noise.range_sigma, noise.range_proportional));
    const auto all = draws(slanted(noise), 1, [&](const auto& reading, std::uint32_t i, double quiet) {
      return (reading.values[i] - quiet) / std::hypot(noise.range_sigma, noise.range_proportional * quiet);
    });
    expect_standard_normal(all);
    expect_independent(all);
  }
}

/// Returns the bearing at which the slanted wall is at `range`: r (sin b - cos b / 2) = 2 + x / 2 - y.
double bearing_at(const base::Pose& X_WS, double range) {
  const double gap = (2.0 + 0.5 * X_WS.x - X_WS.y) / std::hypot(1.0, 0.5);
  const double normal = std::atan2(1.0, -0.5);
  return normal + std::acos(gap / range) - X_WS.yaw;  // the scan lies on the left of the wall's normal
}

/// Angular noise turns the beam before the cast: the range is that of the turned beam on the wall. With large angles, a
/// lane's beams are no longer adjacent.
TEST(Noise, AngularNoiseTurnsTheBeamBeforeItIsCast) {
  struct Case {
    double sigma, fov;
  };
  for (const auto& [sigma, fov] : {Case{0.002, 0.5}, Case{0.03, 0.1}}) {
    SCOPED_TRACE(sigma);
    world::World world = slanted({.angle_sigma = sigma});
    for (world::Mover& mover : world.movers)
      scenes::edit_lasers(mover, [fov = fov](auto& laser) {
        laser.fov = fov;
        laser.X_MS.yaw = M_PI / 2 + 0.47 + 0.6;
      });
    const auto all = draws(world, 4, [sigma = sigma, fov = fov](const auto& reading, std::uint32_t i, double) {
      const double bearing = fov * (-0.5 + 1.0 * i / (kBeams - 1));
      return (bearing_at(reading.X_WS, reading.values[i]) - bearing) / sigma;
    });
    expect_standard_normal(all);
    expect_independent(all);
  }
}

TEST(Noise, MissesHaveNoNoise) {
  world::World world = slanted({.range_sigma = 0.5, .range_proportional = 0.1}, 1.0);
  const Glance glance(world, {.seed = 6});
  for (const auto& reading : glance.readings)
    for (const double range : reading.values) EXPECT_EQ(range, 1.0);
}

}  // namespace
}  // namespace sf::trial
