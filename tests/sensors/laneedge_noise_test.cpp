// Noise of lane edge sensors: a distribution described by sigma, and a pure function of its keys.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tests/device.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using sensors::EdgeReading;

/// `count` sensors in front of a straight edge, 0.4 m ahead, at angles of up to 40 degrees.
world::World noisy_world(std::size_t count, const std::vector<double>& noise) {
  world::World world;
  world.lane_markings.push_back(marking({30.0, 0.45}, {-30.0, 0.45}, 0.1));
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    add_edge_eye(world, {-20.0 + 40.0 * share, 0.0, 0.0, (50.0 + 80.0 * share) * kDegree},
                 {{"perpendicular", {0}}, {"noise", noise}});
  }
  return world;
}

struct Spread {
  double mean = 0.0, deviation = 0.0, within_one = 0.0, within_two = 0.0, kolmogorov = 0.0;
  std::size_t count = 0;
};

/// Statistics of errors in units of the sensors' own sigmas.
Spread spread_of(const world::World& world, int rounds) {
  EdgeRig rig(world, 5);
  std::vector<double> z;
  for (int k = 0; k < rounds; ++k) {
    const auto readings = rig.read(static_cast<std::uint64_t>(k));
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const double truth = 0.4 / std::sin(world.movers[i].X_WM.yaw);
      EXPECT_FALSE(std::isnan(readings[i].distance));
      z.push_back((readings[i].distance - truth) / readings[i].sigma);
    }
  }
  std::sort(z.begin(), z.end());
  Spread s;
  s.count = z.size();
  const auto n = static_cast<double>(z.size());
  for (std::size_t i = 0; i < z.size(); ++i) {
    s.mean += z[i] / n;
    s.deviation += z[i] * z[i] / n;
    s.within_one += (std::fabs(z[i]) < 1.0 ? 1.0 : 0.0) / n;
    s.within_two += (std::fabs(z[i]) < 2.0 ? 1.0 : 0.0) / n;
    const double normal = 0.5 * std::erfc(-z[i] / std::sqrt(2.0));
    s.kolmogorov = std::max(s.kolmogorov, std::fabs(normal - (static_cast<double>(i) + 0.5) / n));
  }
  s.deviation = std::sqrt(s.deviation);
  return s;
}

/// Constant, proportional and angular noise separately and together: sigma is the error's standard deviation within a
/// third, and errors have no bias. Sigma is estimated from 61 points, together with a curvature that is 0 here, so it
/// is conservative.
TEST(LaneEdgeNoise, SigmaIsTheDeviationOfErrors) {
  for (const std::vector<double>& noise :
       {std::vector{0.005, 0.0, 0.0}, {0.0, 0.01, 0.0}, {0.0, 0.0, 0.3}, {0.003, 0.005, 0.2}}) {
    const Spread s = spread_of(noisy_world(300, noise), 10);
    EXPECT_EQ(s.count, 3000u);
    EXPECT_LT(std::fabs(s.mean), 0.12) << noise[0] << " " << noise[1] << " " << noise[2];
    EXPECT_GT(s.deviation, 0.6);
    EXPECT_LT(s.deviation, 1.1);
    EXPECT_GT(s.within_two, 0.95);
    std::printf(
        "noise %g %g %g: mean %+.3f, deviation %.3f, within one %.3f, within two %.3f of sigma; from a normal %.3f\n",
        noise[0], noise[1], noise[2], s.mean, s.deviation, s.within_one, s.within_two, s.kolmogorov);
  }
}

/// The noise of a single ray is the normal distribution of the world file.
TEST(LaneEdgeNoise, SingleRayNoiseIsNormal) {
  world::World world = noisy_world(500, {0.004, 0.005, 0.0});
  for (world::Mover& mover : world.movers) {
    mover.X_WM.yaw = 0.5 * M_PI;
    mover.sensors[0] = edge_sensor({{"samples", {1}}, {"noise", {0.004, 0.005, 0.0}}});
  }
  const Spread s = spread_of(world, 6);
  EXPECT_NEAR(s.deviation, 1.0, 0.05);
  // The Kolmogorov-Smirnov statistic of 3000 draws exceeds 0.03 once in a hundred times.
  EXPECT_LT(s.kolmogorov, 0.03);
}

TEST(LaneEdgeNoise, NoiseCanBeDisabled) {
  const world::World world = noisy_world(50, {0.005, 0.01, 0.3});
  EdgeRig quiet(world, 5, 0, false);
  for (const EdgeReading& r : quiet.read()) EXPECT_LT(r.sigma, 1e-6);
  const auto first = quiet.read(1);
  const auto second = quiet.read(2);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].distance, second[i].distance);
}

bool same(const EdgeReading& p, const EdgeReading& q) {
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  return bits(p.distance) == bits(q.distance) && p.points == q.points && bits(p.residual) == bits(q.residual) &&
         bits(p.sigma) == bits(q.sigma);
}

/// Threads, other sensors and order change no bit. Seed and sequence do.
TEST(LaneEdgeNoise, DependsOnlyOnItsKeys) {
  const world::World exact = noisy_world(150, {0.003, 0.005, 0.2});
  world::World pixels = exact;
  pixels.road_resolution = 0.01;
  for (const world::World* world : std::initializer_list<const world::World*>{&exact, &pixels}) {
    const auto expected = EdgeRig(*world, 5, 1).read(4);
    for (const unsigned threads : {2u, 5u}) {
      const auto again = EdgeRig(*world, 5, threads).read(4);
      for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_TRUE(same(expected[i], again[i])) << i;
    }
    EdgeRig rig(*world, 5);
    std::vector<base::Pose> poses;
    for (const world::Mover& mover : world->movers) poses.push_back(mover.X_WM);
    rig.read(1);
    const auto some = rig.read_some({{140, 4}, {3, 4}, {77, 4}}, poses);
    EXPECT_TRUE(same(some[0], expected[140]));
    EXPECT_TRUE(same(some[1], expected[3]));
    EXPECT_TRUE(same(some[2], expected[77]));
    std::size_t other = 0;
    const auto later = rig.read(5);
    const auto elsewhere = EdgeRig(*world, 6).read(4);
    for (std::size_t i = 0; i < expected.size(); ++i)
      other += !same(expected[i], later[i]) && !same(expected[i], elsewhere[i]) ? 1 : 0;
    EXPECT_GT(other, 145u);
  }
}

/// No sensor is due, then all, then one: the tables follow.
TEST(LaneEdgeNoise, DoesNotDependOnWhichSensorsAreDue) {
  const world::World world = noisy_world(70, {0.0, 0.0, 0.0});
  EdgeRig rig(world);
  std::vector<base::Pose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(mover.X_WM);
  EXPECT_TRUE(rig.read_some({}, poses).empty());
  const auto all = rig.read();
  EXPECT_EQ(all.size(), 70u);
  EXPECT_TRUE(rig.read_some({}, poses).empty());
  EXPECT_TRUE(same(rig.read_some({{69, 0}}, poses)[0], all[69]));
}

/// Deviates of ranges are stored beam by beam and, with bearings that deviate, four places apart.
TEST(LaneEdgeNoise, KernelsAndHostReadTheSameBits) {
  for (const std::vector<double>& noise : {std::vector{0.003, 0.005, 0.0}, {0.003, 0.005, 0.2}}) {
    const world::World world = noisy_world(150, noise);
    const auto by_host = EdgeRig(world, 5).read(4), by_kernels = EdgeRig(world, 5, 0, true, &device()).read(4);
    ASSERT_EQ(by_host.size(), by_kernels.size());
    for (std::size_t i = 0; i < by_host.size(); ++i)
      EXPECT_TRUE(same(by_host[i], by_kernels[i])) << i << " " << noise[2];
  }
}

/// No messages of the validation layer, with exact markings and with the raster.
TEST(LaneEdgeNoise, ValidationLayerIsSilent) {
  setenv("SENSORFARM_VALIDATE", "1", 1);
  {
    gpu::Device checked;
    if (checked.validation_messages().find("not installed") != std::string::npos)
      GTEST_SKIP() << "the validation layer is not installed";
    world::World world = noisy_world(20, {0.005, 0.01, 0.3});
    for (const double h : {0.0, 0.01}) {
      world.road_resolution = h;
      EdgeRig rig(world, 5, 0, true, &checked);
      for (std::uint64_t k = 0; k < 3; ++k) EXPECT_EQ(rig.read(k).size(), 20u);
    }
    EXPECT_EQ(checked.validation_messages(), "");
  }
  unsetenv("SENSORFARM_VALIDATE");
}

}  // namespace
}  // namespace sf::trial
