// The magnetometers' noise is a distribution of independent draws.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensors/magnetometer.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/sensors/statistics.h"

namespace sf::trial {
namespace {

using scenes::Element;
using scenes::element;

struct NoiseDraws {
  std::vector<double> of[4];  ///< field (of the sum of magnitudes), x, y, z, in sigmas
  std::size_t lengths_wrong = 0;
};

NoiseDraws draw_noise(bool magnitudes) {
  constexpr double kSigma = 0.02;  // [Gauss]
  world::World world = scenes::sheet(20, 1.0, 13);
  for (int i = 0; i < 40; ++i) {
    world::Sensor sensor = scenes::five();
    sensor.settings.push_back(scenes::setting("noise", {kSigma}));
    if (magnitudes) sensor.settings.push_back(scenes::text("sum", "magnitude"));
    scenes::add_carrier(world, {0.01 * i, 0, 0, 0.1 * i}, sensor);
  }
  NoiseDraws draws;
  for_noisy_readings(world, 5, 20, 100'000'000, [&](const auto& noisy, const auto& quiet) {
    for (std::size_t e = 0; e < 5; ++e) {
      const Element n = element(noisy, e), q = element(quiet, e);
      const double unit = kSigma * sensors::kGauss;
      const double all[] = {(n.field - q.field) / unit, (n.x - q.x) / unit, (n.y - q.y) / unit, (n.z - q.z) / unit};
      for (std::size_t k = 0; k < 4; ++k) draws.of[k].push_back(all[k]);
      draws.lengths_wrong += std::fabs(n.field - std::hypot(n.x, n.y, n.z)) > 1e-15;
    }
  });
  return draws;
}

/// Each component is normal with the file's sigma; components, elements, robots and ticks are uncorrelated.
TEST(MagnetometerNoise, IsNormalAndIndependentOnEachComponent) {
  const NoiseDraws draws = draw_noise(true);
  const double some = 4.0 / std::sqrt(4000.0);  // four standard deviations
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_EQ(draws.of[k].size(), 4000u);
    EXPECT_LT(ks(draws.of[k]), 1.95) << k;
    for (const std::size_t lag : {1u, 5u, 200u}) EXPECT_LT(std::fabs(correlation(draws.of[k], draws.of[k], lag)), some);
    for (std::size_t j = 0; j < k; ++j) EXPECT_LT(std::fabs(correlation(draws.of[k], draws.of[j], 0)), some);
  }
}

TEST(MagnetometerNoise, FieldIsTheLengthOfTheNoisyVector) { EXPECT_EQ(draw_noise(false).lengths_wrong, 0u); }

TEST(MagnetometerNoise, IsAddedBeforeSaturation) {
  world::World world;
  world::Sensor sensor = scenes::five();
  sensor.settings.push_back(scenes::setting("noise", {1.0}));
  sensor.settings.push_back(scenes::setting("ssensitivity", {-0.5, 0.5}));
  for (int i = 0; i < 40; ++i) scenes::add_carrier(world, {0, 0, 0, 0}, sensor);
  const Glance run(world, {.seed = 9});
  std::size_t low = 0, high = 0;
  for (const base::ReadingBlock& r : run.readings)
    for (const double tesla : r.values) {
      ASSERT_GE(tesla, -0.5 * sensors::kGauss);
      ASSERT_LE(tesla, 0.5 * sensors::kGauss);
      low += tesla == -0.5 * sensors::kGauss;
      high += tesla == 0.5 * sensors::kGauss;
    }
  EXPECT_GT(low, 50u);
  EXPECT_GT(high, 50u);
}

}  // namespace
}  // namespace sf::trial
