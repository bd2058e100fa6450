// The device and the plain C++ caster produce equal bits.

#include "sensors/laser_reference.h"

#include <gtest/gtest.h>

#include "tests/instrumented.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const std::uint32_t kReferenceRobots = instrumented() ? 20 : 200;

struct Disagreement {
  std::size_t beams = 0;
  std::size_t ranges = 0;  ///< with different bits
  std::size_t hits = 0;
  double largest = 0.0;  ///< [m]
  std::string example;
};

/// Runs three ticks of a farm with small motions of all robots and compares every beam of every laser with the
/// reference.
Disagreement disagreement(const world::World& world, std::uint64_t seed, bool noise = true) {
  farm::Farm farm(world, device(), {.seed = seed, .noise = noise});
  farm.subscribe_all();
  sensors::LaserReference reference(world, seed, noise);
  Disagreement found;
  std::vector<base::Pose> poses = loaded_poses(world);
  for (int tick = 0; tick < 3; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < poses.size(); ++m) {
      poses[m].x += 0.003 * tick;
      poses[m].yaw += 0.7 * tick;
      reports.push_back({m, 0, poses[m], {}});
    }
    reference.set_poses(poses);
    for (const base::ReadingBlock& r : farm.tick(tick * 1'000'000'000ll, reports)) {
      const sensors::LaserReference::Scan scan = reference.scan(r.mover, r.sensor, r.sequence);
      for (std::size_t i = 0; i < r.values.size(); ++i, ++found.beams) {
        found.hits += r.hits[i] != scan.hits[i];
        if (r.values[i] == scan.ranges[i]) continue;
        ++found.ranges;
        found.largest = std::max(found.largest, std::abs(r.values[i] - scan.ranges[i]));
        if (found.example.empty())
          found.example = (testing::Message()
                           << "mover " << r.mover << " beam " << i << ": " << r.values[i] << " and " << scan.ranges[i])
                              .GetString();
      }
    }
  }
  return found;
}

void expect_same_bits(const std::string& name, const Disagreement& d) {
  std::printf("[ measured ] %s: %zu beams, %zu ranges and %zu hits not the same, by %.2g m at most\n", name.c_str(),
              d.beams, d.ranges, d.hits, d.largest);
  EXPECT_EQ(d.ranges, 0u) << name << ": " << d.example;
  EXPECT_EQ(d.hits, 0u) << name;
}

world::World crowd(const sensors::LaserSettings& laser, std::uint64_t seed) {
  world::World world = scenes::boxes(60, 16.0, seed);
  scenes::add_robots(world, kReferenceRobots, laser, seed);
  return world;
}

TEST(LaserReference, AmongBoxesAndRobots) { expect_same_bits("boxes", disagreement(crowd(scenes::laser(), 1), 1)); }

TEST(LaserReference, InSkipModes) {
  world::World world = crowd(scenes::laser(), 2);
  for (std::size_t m = 0; m < world.movers.size(); ++m)
    scenes::edit_laser(world.movers[m])->accuracy.word = m % 2 == 0 ? "skip2" : "skip8";
  expect_same_bits("skip2 and skip8", disagreement(world, 1));
}

TEST(LaserReference, InACave) {
  world::World world = scenes::cave(100, 16.0, 3);
  scenes::add_robots(world, kReferenceRobots / 4, scenes::laser(), 3);
  expect_same_bits("cave", disagreement(world, 1));
}

TEST(LaserReference, WithNoise) {
  sensors::LaserSettings laser = scenes::laser(181, 2.0 * M_PI, 6.0);
  laser.noise = {.range_sigma = 0.01, .range_proportional = 0.02, .angle_sigma = 0.005};
  expect_same_bits("noise", disagreement(crowd(laser, 2), 7));
  expect_same_bits("noise left out", disagreement(crowd(laser, 2), 7, false));
}

TEST(LaserReference, WithSkippedBeams) {
  sensors::LaserSettings laser = scenes::laser(361, M_PI, 8.0);
  laser.resolution = 7;
  laser.range_min = 0.4;
  expect_same_bits("resolution 7", disagreement(crowd(laser, 4), 1));
}

TEST(LaserReference, WithWidelySpacedBeams) {
  // Lanes of one beam: four neighbours would not fit into a sector.
  expect_same_bits("12 beams", disagreement(crowd(scenes::laser(12, 2.0 * M_PI, 5.0), 5), 1));
  expect_same_bits("1 beam", disagreement(crowd(scenes::laser(1, 0.0, 5.0), 6), 1));
}

TEST(LaserReference, FarFromTheOrigin) {
  world::World world = crowd(scenes::laser(), 8);
  world::translate(world, 1e7, -1e5);
  expect_same_bits("far away", disagreement(world, 1));
}

TEST(LaserReference, ReturnsEachRobotsLasersAsCast) {
  world::World world = crowd(scenes::laser(181), 2);
  scenes::remove_lasers(world.movers[0]);
  world.movers[1].sensors.push_back(sensors::laser_sensor(scenes::laser(9, 1.0, 3.0)));
  scenes::edit_laser(world.movers[1], 1)->accuracy.word = "skip4";
  scenes::edit_laser(world.movers[2])->accuracy.word = "single";
  const sensors::LaserReference reference(world, 1);
  EXPECT_EQ(reference.laser(1, 0).laser.samples, 181u);
  EXPECT_EQ(reference.laser(1, 1).laser.samples, 9u);
  EXPECT_EQ(reference.laser(1, 1).laser.resolution, 4u);
  EXPECT_FALSE(reference.laser(1, 1).single);
  EXPECT_TRUE(reference.laser(2, 0).single);
}

/// The comparison detects differences: another seed produces different noise.
TEST(LaserReference, DetectsAnotherSeed) {
  sensors::LaserSettings laser = scenes::laser(61);
  laser.noise.range_sigma = 0.01;
  const world::World world = crowd(laser, 2);
  farm::Farm farm(world, device(), {.seed = 2});
  farm.subscribe_all();
  const base::ReadingBlock r = farm.tick(0, {})[0];
  EXPECT_NE(sensors::LaserReference(world, 3).scan(r.mover, 0, 0).ranges,
            std::vector<double>(r.values.begin(), r.values.end()));
  EXPECT_EQ(sensors::LaserReference(world, 2).scan(r.mover, 0, 0).ranges,
            std::vector<double>(r.values.begin(), r.values.end()));
}

}  // namespace
}  // namespace sf::trial
