// Gyros: the reported yaw rate, with errors per run and per reading.

#include "sensors/gyro.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/host_trial.h"
#include "tests/sensors/statistics.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

/// Returns the readings of `robots` gyros over `ticks`, all turning at `turn` [rad/s], robot by robot.
std::vector<std::vector<double>> turning(const world::World& world, double turn, int ticks,
                                         farm::FarmOptions options = {}) {
  farm::Farm farm(world, device(), options);
  farm.subscribe_all();
  std::vector<base::Report> states = robots::states_at_load(world);
  for (base::Report& s : states) s.velocity.turn = turn;
  std::vector<std::vector<double>> rates(world.movers.size());
  for (int tick = 0; tick < ticks; ++tick)
    for (const auto& r : farm.tick(tick * 100'000'000ll, states)) rates[r.mover].push_back(r.values[0]);
  return rates;
}

world::World gyros(std::size_t count, std::vector<world::Setting> settings) {
  return carriers(fitted("gyro", std::move(settings)), std::vector<base::Pose>(count));
}

TEST(Gyro, PerfectGyroReadsTheTurnRate) {
  for (const double turn : {0.0, 1.25, -7.0}) EXPECT_EQ(turning(gyros(1, {}), turn, 1)[0][0], turn);
}

TEST(Gyro, SaturatesInBothDirections) {
  const world::World world = gyros(1, {setting("range", {90})});
  EXPECT_DOUBLE_EQ(turning(world, 2.0, 1)[0][0], M_PI / 2);
  EXPECT_DOUBLE_EQ(turning(world, -2.0, 1)[0][0], -M_PI / 2);
  EXPECT_EQ(turning(world, 1.5, 1)[0][0], 1.5);
}

TEST(Gyro, NoiseIsNormalAndIndependentPerReading) {
  const auto rates = turning(gyros(50, {setting("noise", {0.5})}), 1.0, 40, {.seed = 3});
  std::vector<double> draws;
  for (const auto& robot : rates)
    for (const double rate : robot) draws.push_back((rate - 1.0) / (0.5 * kDegree));
  ASSERT_EQ(draws.size(), 2000u);
  EXPECT_LT(ks(draws), 1.95);
  const double some = 4.0 / std::sqrt(2000.0);
  EXPECT_LT(std::abs(correlation(draws, draws, 1)), some) << "from reading to reading";
  EXPECT_LT(std::abs(correlation(draws, draws, 40)), some) << "from robot to robot";
}

TEST(Gyro, BiasIsDrawnPerRun) {
  const world::World world = gyros(1000, {setting("bias", {2.0})});
  const auto one = turning(world, 0.0, 2, {.seed = 4}), other = turning(world, 0.0, 1, {.seed = 5});
  std::vector<double> draws, others;
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i][0], one[i][1]) << "all through the run";
    draws.push_back(one[i][0] / (2.0 * kDegree));
    others.push_back(other[i][0] / (2.0 * kDegree));
  }
  EXPECT_LT(ks(draws), 1.95);
  EXPECT_LT(std::abs(correlation(draws, others)), 4.0 / std::sqrt(1000.0)) << "another seed, another run";
}

TEST(Gyro, ScaleErrorIsDrawnPerRunAndGrowsWithTheRate) {
  const world::World world = gyros(1000, {setting("scale_error", {0.01})});
  const auto slow = turning(world, 1.0, 1, {.seed = 6}), fast = turning(world, 3.0, 1, {.seed = 6});
  std::vector<double> draws;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    draws.push_back((slow[i][0] - 1.0) / 0.01);
    EXPECT_NEAR(fast[i][0], 3.0 * slow[i][0], 1e-12);
  }
  EXPECT_LT(ks(draws), 1.95);
}

TEST(Gyro, ErrorsOfARunAreIndependent) {
  const auto biased = turning(gyros(1000, {setting("bias", {1.0})}), 0.0, 1, {.seed = 7});
  const auto scaled = turning(gyros(1000, {setting("scale_error", {0.1})}), 1.0, 1, {.seed = 7});
  const auto noisy = turning(gyros(1000, {setting("noise", {1.0})}), 0.0, 1, {.seed = 7});
  std::vector<double> b, s, n;
  for (std::size_t i = 0; i < 1000; ++i) {
    b.push_back(biased[i][0] / kDegree);
    s.push_back((scaled[i][0] - 1.0) / 0.1);
    n.push_back(noisy[i][0] / kDegree);
  }
  const double some = 4.0 / std::sqrt(1000.0);
  EXPECT_LT(std::abs(correlation(b, s)), some);
  EXPECT_LT(std::abs(correlation(b, n)), some);
  EXPECT_LT(std::abs(correlation(s, n)), some);
}

TEST(Gyro, IsPerfectWithoutNoise) {
  const world::World world = gyros(2, {setting("bias", {1}), setting("noise", {1}), setting("scale_error", {0.5})});
  EXPECT_EQ(turning(world, 0.75, 1, {.noise = false})[1][0], 0.75);
}

TEST(Gyro, RejectsInvalidSettings) {
  expect_refused("gyro", {setting("bias", {-1})}, 8, "'bias' is -1");
  expect_refused("gyro", {setting("noise", {-1})}, 8, "'noise' is -1");
  expect_refused("gyro", {setting("scale_error", {2})}, 8, "'scale_error' is 2");
  expect_refused("gyro", {setting("bias", {1}), setting("range", {0})}, 9, "'range' is 0");
  expect_refused("gyro", {text("range", "far")}, 8, "'range' expects a number");
}

}  // namespace
}  // namespace sf::trial
