// Radars: ranges, bearings and closing speeds of movers, occlusion, limits, errors and refusals.

#include "sensors/radar.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "robots/kinematics.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/series.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using base::Report;

struct Row {
  double range, bearing, closing, elevation;
};

/// A robot with a radar at its origin, 0.25 m above the ground, among other things.
world::World radar_world(const std::string& radar, const std::string& others) {
  return world_of(
      "define car position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
      "define post model( size [0.1 0.1 2] )\n"
      "car( name \"own\" radar( pose [0 0 -0.25 0] size [0 0 0] " +
      radar + " ) )\n" + others);
}

/// Returns the states at load, with the velocities of the first movers.
std::vector<Report> states(const world::World& world, const std::vector<base::Twist>& velocities = {}) {
  std::vector<Report> reports;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    reports.push_back({m, 0, world.movers[m].X_WM, m < velocities.size() ? velocities[m] : base::Twist{}});
  return reports;
}

std::vector<double> values_at(const world::World& world, const std::vector<Report>& reports,
                              const farm::FarmOptions& options = {.threads = 1}) {
  farm::Farm farm(world, host_device(), options);
  farm.subscribe(0, base::only(sensors::kRadar));
  const auto readings = farm.tick(0, reports);
  return {readings[0].values.begin(), readings[0].values.end()};
}

std::vector<Row> rows_of(const std::vector<double>& values) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < values.size(); i += 4)
    if (!std::isnan(values[i])) rows.push_back({values[i], values[i + 1], values[i + 2], values[i + 3]});
  return rows;
}

std::vector<Row> read_radar(const world::World& world, const std::vector<base::Twist>& velocities = {}) {
  return rows_of(values_at(world, states(world, velocities)));
}

TEST(Radar, ClosingSpeedsInClosedForm) {
  const world::World world = radar_world("", "car( pose [10 0 0 180] )");
  const auto closing = [&](base::Twist own, base::Twist other) {
    return read_radar(world, {own, other}).at(0).closing;
  };
  const auto rows = read_radar(world, {{3.0, 0.0, 0.0}, {2.0, 0.0, 0.0}});
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].range, 9.8, 1e-8) << "the front face";
  EXPECT_NEAR(rows[0].bearing, 0.0, 1e-12);
  EXPECT_EQ(rows[0].elevation, 0.0);
  EXPECT_NEAR(rows[0].closing, 5.0, 1e-12) << "head-on: the sum of both speeds";
  EXPECT_NEAR(closing({3.0, 0.0, 0.0}, {-3.0, 0.0, 0.0}), 0.0, 1e-12) << "followed at its speed";
  EXPECT_NEAR(closing({0.0, 0.0, 0.0}, {-2.0, 0.0, 0.0}), -2.0, 1e-12) << "going away";
  EXPECT_NEAR(closing({0.0, 1.0, 0.0}, {0.0, 5.0, 0.0}), 0.0, 1e-12) << "crossing straight ahead";
  EXPECT_NEAR(closing({0.0, 0.0, 2.0}, {}), 0.0, 1e-12) << "the radar turns about itself";
  EXPECT_NEAR(closing({}, {0.0, 0.0, 2.0}), 0.0, 1e-12) << "the target turns about an axis behind the point ahead";
  EXPECT_NEAR(closing({}, {0.0, 20.0, -2.0}), 0.0, 1e-8) << "the target circles the radar";
  EXPECT_NEAR(closing({0.0, 0.0, 2.0}, {0.0, -20.0, 2.0}), 0.0, 1e-8) << "both turn as one body";
}

/// A target off the axis has the part of its speed along the line of sight, and turns add to it.
TEST(Radar, ClosingSpeedIsTheDerivativeOfTheRangeToThePoint) {
  Chance chance(5);
  int checked = 0;
  for (int trial = 0; trial < 40; ++trial) {
    world::World world = radar_world("fov 360 columns 720 pose6 [1.5 -0.7 0 0 0 70]", "car( pose [8 0 0 0] )");
    const auto twist = [&] { return base::Twist{chance.between(-9, 9), chance.between(-2, 2), chance.between(-2, 2)}; };
    world.movers[1].X_WM = {chance.between(3, 9), chance.between(-9, 9), 0, chance.between(-3, 3)};
    const base::Twist v[] = {twist(), twist()};
    const auto rows = read_radar(world, {v[0], v[1]});
    if (rows.empty()) continue;
    ++checked;
    const Pose X_MS{1.5, -0.7, 0, 70 * kDegree}, X_WS = base::compose({}, X_MS);
    const glm::dvec2 p = base::transform(X_WS, rows[0].range * base::direction(rows[0].bearing));
    const glm::dvec2 in_target = base::transform(base::inverse(world.movers[1].X_WM), p);
    const auto range_after = [&](double dt) {
      const Pose own = base::compose(robots::advance({}, v[0], dt), X_MS),
                 other = robots::advance(world.movers[1].X_WM, v[1], dt);
      return glm::length(base::transform(other, in_target) - glm::dvec2{own.x, own.y});
    };
    constexpr double kStep = 1e-4;
    EXPECT_NEAR(rows[0].closing, (range_after(-kStep) - range_after(kStep)) / (2 * kStep), 1e-5) << trial;
    EXPECT_NEAR(range_after(0.0), rows[0].range, 1e-8);
  }
  EXPECT_GE(checked, 30) << "a few are beyond the spacing of beams";
}

TEST(Radar, TiltedBodiesMoveAlongTheirSlope) {
  const world::World world = radar_world("", "car( pose [10 0 0 180] )");
  const base::Tilt up{0.0, -0.3}, down{0.0, 0.3};
  std::vector<Report> reports = states(world, {{0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}});
  reports[0].tilt = up, reports[1].tilt = down;
  reports[1].X_WM.x = 10 * std::cos(0.3), reports[1].X_WM.z = 10 * std::sin(0.3);
  const auto rows = rows_of(values_at(world, reports));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].range, 9.8, 1e-8) << "both are on one slope";
  EXPECT_NEAR(rows[0].closing, 2.0 / std::cos(0.3), 1e-9) << "the way along the slope is longer than in the plane";
  reports[0].velocity = {-2.0, 0.0, 0.0};
  EXPECT_NEAR(rows_of(values_at(world, reports)).at(0).closing, 0.0, 1e-9) << "backing off as fast";
}

TEST(Radar, WhatIsHidden) {
  const auto count = [](const std::string& others) { return read_radar(radar_world("", others)).size(); };
  const std::string target = "car( pose [10 0 0 0] )\n";
  EXPECT_EQ(count(target), 1u);
  EXPECT_EQ(count(target + "model( pose [5 0 0 0] size [0.1 2 1] )"), 0u) << "behind a wall";
  EXPECT_EQ(count(target + "model( pose [5 0 0 0] size [0.1 2 0.2] )"), 1u) << "the radar looks over it";
  EXPECT_EQ(count(target + "model( pose [5 0 0 0] size [0.1 2 1] laser_return 0 )"), 1u) << "invisible to lasers";
  EXPECT_EQ(count(target + "car( pose [5 0 0 0] )"), 1u) << "the nearer mover hides the other one";
  const auto half = read_radar(radar_world("", target + "model( pose [5 -1 0 0] size [0.1 2 1] )"));
  ASSERT_EQ(half.size(), 1u);
  EXPECT_GT(half[0].bearing, 0.0) << "the part in sight, to the left of the wall";
  EXPECT_NEAR(half[0].range * std::cos(half[0].bearing), 9.8, 1e-8);
}

TEST(Radar, LimitsOfRangeAndField) {
  const auto seen = [](const std::string& radar, const std::string& pose) {
    return !read_radar(radar_world(radar, "car( pose [" + pose + "] )")).empty();
  };
  EXPECT_TRUE(seen("range [0 5]", "5.199 0 0 0")) << "its face is in range";
  EXPECT_FALSE(seen("range [0 5]", "5.201 0 0 0")) << "beyond the range";
  EXPECT_TRUE(seen("range [2 5] columns 1", "2.201 0 0 0")) << "its face is just far enough";
  EXPECT_FALSE(seen("range [2 5] columns 1", "2.199 0 0 0")) << "too near";
  EXPECT_TRUE(seen("fov 90", "5 5.1 0 45")) << "its edge reaches into the field";
  EXPECT_FALSE(seen("fov 90", "5 5.4 0 45")) << "outside on the left";
  EXPECT_FALSE(seen("fov 90", "5 -5.4 0 45")) << "outside on the right";
  EXPECT_FALSE(seen("fov 90", "-5 0 0 0")) << "behind";
  EXPECT_TRUE(seen("fov 360", "-5 0 0 0")) << "all round";
}

TEST(Radar, NearestFirstUpToTheNumberOfRows) {
  const std::string others = "car( pose [10 0 0 0] )\ncar( pose [6 3 0 0] )\ncar( pose [5 -3 0 0] )\n";
  const auto all = values_at(radar_world("targets 5", others), states(radar_world("", others)));
  ASSERT_EQ(all.size(), 20u);
  EXPECT_LT(all[0], all[4]);
  EXPECT_LT(all[4], all[8]);
  EXPECT_LT(all[1], 0.0) << "the nearest is on the right";
  for (std::size_t k = 12; k < 20; ++k) EXPECT_TRUE(std::isnan(all[k])) << "no further targets";
  const auto rows = read_radar(radar_world("targets 2", others));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1].range, all[4]) << "the farthest is left out";
}

TEST(Radar, StaticModelsAndChannelsOnRequest) {
  const std::string others = "post( pose [6 1 0 0] )\ncar( pose [10 0 2 0] )\n";
  EXPECT_EQ(read_radar(radar_world("", others)).size(), 0u) << "a post is no mover, and the car is above the plane";
  const auto posts = read_radar(radar_world("static 1", others), {{2.0, 0.0, 0.0}});
  ASSERT_EQ(posts.size(), 1u);
  EXPECT_NEAR(posts[0].closing, 2.0 * std::cos(posts[0].bearing), 1e-12) << "the radar approaches it";
  const auto above = read_radar(radar_world("channels 21 fov_v 40", others), {{}, {-3.0, 0.0, 0.0}});
  ASSERT_EQ(above.size(), 1u);
  EXPECT_GT(above[0].elevation, 10 * kDegree);
  EXPECT_NEAR(above[0].closing, 3.0 * std::cos(above[0].elevation) * std::cos(above[0].bearing), 1e-9);
}

TEST(Radar, UnresolvedTargetsMerge) {
  const std::string others = "car( pose [10 0.5 0 0] )\ncar( pose [10.3 -0.5 0 0] )\n";
  const auto count = [&](const std::string& radar, double other_speed) {
    return read_radar(radar_world(radar, others), {{}, {}, {other_speed, 0.0, 0.0}}).size();
  };
  EXPECT_EQ(count("", 0.0), 2u) << "off by default";
  EXPECT_EQ(count("resolution [0.5 10 0.2]", 0.0), 1u) << "one cell";
  EXPECT_EQ(count("resolution [0.2 10 0.2]", 0.0), 2u) << "apart in range";
  EXPECT_EQ(count("resolution [0.5 1 0.2]", 0.0), 2u) << "apart in bearing";
  EXPECT_EQ(count("resolution [0.5 10 0.2]", 0.3), 2u) << "apart in speed";
}

/// Many readings of one target at rest, at 9.8 m ahead.
TEST(Radar, ErrorsHaveTheStatedDistributions) {
  const auto deviations = [](const std::vector<std::vector<double>>& all, std::size_t column, double truth) {
    double sum = 0.0, squares = 0.0;
    for (const auto& values : all) sum += values[column] - truth, squares += std::pow(values[column] - truth, 2);
    const auto n = static_cast<double>(all.size());
    return std::pair{sum / n, std::sqrt(squares / n)};
  };
  const std::string other = "car( pose [10 0 0 0] )";
  const auto noisy = series(radar_world("noise [0.1 1 0.2 2] targets 1", other), sensors::kRadar, 1000);
  const double sigmas[] = {0.1, kDegree, 0.2, 2 * kDegree}, truths[] = {9.8, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto [mean, sigma] = deviations(noisy, k, truths[k]);
    EXPECT_NEAR(mean, 0.0, 4 * sigmas[k] / std::sqrt(1000.0)) << "column " << k;
    EXPECT_NEAR(sigma, sigmas[k], 0.1 * sigmas[k]) << "column " << k << ", four deviations of 1000 draws";
  }
  const auto rounded = read_radar(radar_world("step [0.5 1 0.4]", other), {{}, {-1.1, 0.0, 0.0}});
  EXPECT_DOUBLE_EQ(rounded.at(0).range, 10.0);
  EXPECT_DOUBLE_EQ(rounded.at(0).closing, 1.2) << "-1.1 m/s backwards towards the radar, in steps of 0.4";
}

TEST(Radar, DetectionFallsWithRange) {
  EXPECT_DOUBLE_EQ(sensors::detection_probability(20.0, 20.0), 0.5);
  EXPECT_DOUBLE_EQ(sensors::detection_probability(0.0, 20.0), 1.0);
  EXPECT_GT(sensors::detection_probability(10.0, 20.0), 0.95) << "the signal is sixteen times as strong";
  EXPECT_LT(sensors::detection_probability(60.0, 20.0), 1e-4) << "81 times weaker";
  const auto all =
      series(radar_world("detection_range 9.8 targets 1", "car( pose [10 0 0 0] )"), sensors::kRadar, 1000);
  const auto seen = std::ranges::count_if(all, [](const auto& values) { return !std::isnan(values[0]); });
  EXPECT_NEAR(static_cast<double>(seen), 500.0, 4 * std::sqrt(250.0)) << "a binomial count";
}

TEST(Radar, ReadingsDoNotDependOnThreads) {
  std::string others;
  for (int i = 0; i < 12; ++i)
    others += "car( pose [" + std::to_string(3 + i) + " " + std::to_string(2 * (i % 5) - 4) + " 0 " +
              std::to_string(30 * i) + "] )\n";
  const world::World world = radar_world("noise [0.1 1 0.2] detection_range 9 channels 7 fov_v 10", others);
  const auto reports = states(world, std::vector<base::Twist>(13, {1.0, 0.1, 0.3}));
  const auto one = values_at(world, reports, {.threads = 1}), four = values_at(world, reports, {.threads = 4});
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(double)), 0);
  EXPECT_FALSE(std::isnan(one[0]));
}

/// Robots of one copy neither see those of others nor draw their numbers.
TEST(Radar, CopiesReadAsTheirWorldsAlone) {
  const world::World alone = radar_world("noise [0.1 1 0.2]", "car( pose [8 0 0 0] )");
  world::World world = alone;
  world::copy_movers(world, 2);
  std::vector<Report> all = states(world, {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {2.0, 0.0, 0.0}, {0.0, 0.0, 1.0}});
  all[3].X_WM.x = 5.0;
  farm::Farm farm(world, host_device(), {.seed = 1, .threads = 1});
  farm.subscribe_all();
  const auto readings = farm.tick(0, all);
  ASSERT_EQ(readings.size(), 2u);
  const std::vector<Report> second{{0, 0, all[2].X_WM, all[2].velocity}, {1, 0, all[3].X_WM, all[3].velocity}};
  const auto expected = values_at(alone, second, {.seed = 2, .threads = 1});
  ASSERT_LT(expected[0], 6.0);
  EXPECT_EQ(std::memcmp(readings[1].values.data(), expected.data(), expected.size() * sizeof(double)), 0);
}

TEST(Radar, InvalidSettingsAreRefused) {
  const auto refusal = [](const std::string& radar) {
    return refusal_of([&] { sensors::SensorSet sensor_set(radar_world(radar, "")); });
  };
  expect_in("expected 1 to 78", refusal("targets 79"));
  expect_in("a range from 5 to 4 m", refusal("range [5 4]"));
  expect_in("expected at most 65536", refusal("columns 3600 channels 64 fov_v 10"));
  expect_in("expected both, or neither", refusal("channels 3"));
  expect_in("expected both, or neither", refusal("fov_v 3"));
  expect_in("'noise' has -1", refusal("noise [-1]"));
  expect_in("[range bearing speed", refusal("resolution [1 2]"));
  expect_in("'noise' has 5 numbers", refusal("noise [1 1 1 1 1]"));
  expect_in("'resolution' has 4 numbers", refusal("resolution [1 1 1 1]"));
  expect_in("'resolution' has a 0", refusal("resolution [1 0 1]"));
  expect_in("expected 0 to 1", refusal("static 2"));
  EXPECT_EQ(refusal(""), "");
}

}  // namespace
}  // namespace sf::trial
