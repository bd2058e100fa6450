// Ranges at their limits (docs/sensors.md): value, flag and model of lasers on both casters, of the plain reference,
// and of sonar and infrared.

#include <gtest/gtest.h>

#include <cmath>

#include "raycast/casters.h"
#include "sensors/accuracy.h"
#include "sensors/laser_reference.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::Pose;
using base::QualityFlag;
using enum QualityFlag;

constexpr double kMin = 0.5, kMax = 4.0;

/// A long wall across the x axis at x = `at`.
world::World wall_between(double at, double low = -5.0, double high = 5.0) {
  world::World world;
  scenes::add_outline(world, {{at, low}, {at + 1, low}, {at + 1, high}, {at, high}}, "wall");
  return world;
}

sensors::LaserSettings limited(std::uint32_t samples, double fov, std::uint32_t resolution = 1) {
  sensors::LaserSettings laser = eye(samples, fov, kMax);
  laser.range_min = kMin;
  laser.resolution = resolution;
  return laser;
}

QualityFlag flag_of(const base::ReadingBlock& reading, std::size_t i) {
  return reading.quality.empty() ? none : reading.quality[i];
}

std::vector<QualityFlag> flags_of(const base::ReadingBlock& reading) {
  std::vector<QualityFlag> flags;
  for (std::size_t i = 0; i < reading.values.size(); ++i) flags.push_back(flag_of(reading, i));
  return flags;
}

struct Case {
  const char* why;
  double wall;   ///< [m] distance along the beam
  double range;  ///< [m] as read
  QualityFlag flag;
  bool named;  ///< true: the reading has a model
};

const Case kCases[] = {
    {"a surface that touches the sensor", 0.0, kMin, too_near, true},
    {"the last number below the minimum", std::nextafter(kMin, 0.0), kMin, too_near, true},
    {"at the minimum", kMin, kMin, none, true},
    {"the first number above the minimum", std::nextafter(kMin, 1.0), std::nextafter(kMin, 1.0), none, true},
    {"in range", 2.0, 2.0, none, true},
    {"the last number below the maximum", std::nextafter(kMax, 0.0), std::nextafter(kMax, 0.0), none, true},
    {"at the maximum", kMax, kMax, none, false},
    {"the first number above the maximum", std::nextafter(kMax, 9.0), kMax, none, false},
    {"no surface in reach", 100.0, kMax, none, false},
};

class LaserLimits : public testing::TestWithParam<std::tuple<std::string, const char*>> {};

TEST_P(LaserLimits, ValueFlagAndModel) {
  const auto& [caster, mode] = GetParam();
  const bool single = mode == std::string("single");
  for (const Case& c : kCases) {
    // Ranges in 32 bits do not distinguish a number from the next one.
    if (single && c.wall != kMin && std::abs(c.wall - kMin) < 1e-9) continue;
    world::World world = wall_between(c.wall);
    add_eye(world, {}, limited(5, 0.2));
    sensors::set_accuracy(world, mode);
    const Glance glance(world, {.scene = {.caster = raycast::caster_named(caster)}});
    const base::ReadingBlock& reading = glance.readings[0];
    EXPECT_NEAR(reading.values[2], c.range, single ? 1e-3 : 1e-15) << c.why;
    EXPECT_EQ(reading.values[2] == kMax, !c.named) << c.why;
    EXPECT_EQ(reading.values[2] == kMin, c.range == kMin) << c.why;
    EXPECT_EQ(flag_of(reading, 2), c.flag) << c.why;
    EXPECT_EQ(reading.hits[2], c.named ? world.walls[0].model : base::kNoHit) << c.why;
  }
}

INSTANTIATE_TEST_SUITE_P(Casters, LaserLimits,
                         testing::Combine(testing::ValuesIn(raycast::caster_words()),
                                          testing::Values("exact", "single", "skip2")));

/// The device, the host and the plain reference agree bit by bit, with noise and interpolation.
TEST(RangeLimits, ReferenceIsBitIdentical) {
  for (const double sigma : {0.0, 3.0})
    for (const std::uint32_t resolution : {1u, 3u}) {
      world::World world = wall_between(0.49);
      sensors::LaserSettings laser = limited(40, 2.8, resolution);
      laser.noise.range_sigma = sigma;
      add_eye(world, {}, laser);
      const Glance glance(world, {.seed = 4});
      const base::ReadingBlock& reading = glance.readings[0];
      const auto plain = sensors::LaserReference(world, 4).scan(0, 0, 0);
      EXPECT_EQ(std::vector(reading.values.begin(), reading.values.end()), plain.ranges);
      EXPECT_EQ(std::vector(reading.hits.begin(), reading.hits.end()), plain.hits);
      for (std::size_t i = 0; i < plain.quality.size(); ++i)
        EXPECT_EQ(flag_of(reading, i) == too_near, plain.quality[i] == too_near) << i;
    }
}

TEST(RangeLimits, NoiseMovesRangesOutOfRangeButNotTooNear) {
  world::World world = wall_between(2.0);
  sensors::LaserSettings laser = limited(400, 0.1);
  laser.noise.range_sigma = 3.0;
  add_eye(world, {}, laser);
  const Glance glance(world);
  const base::ReadingBlock& reading = glance.readings[0];
  std::size_t low = 0, high = 0;
  for (std::size_t i = 0; i < reading.values.size(); ++i) {
    ASSERT_GE(reading.values[i], kMin);
    ASSERT_LE(reading.values[i], kMax);
    low += reading.values[i] == kMin, high += reading.values[i] == kMax;
    EXPECT_EQ(reading.hits[i] == base::kNoHit, reading.values[i] == kMax) << reading.values[i];
  }
  EXPECT_GT(low, 10u);
  EXPECT_GT(high, 10u);
  EXPECT_TRUE(reading.quality.empty()) << "the surface is not too near, whatever its range says";
}

TEST(RangeLimits, NoiseDoesNotHideSurfacesThatAreTooNear) {
  world::World world = wall_between(0.3);
  sensors::LaserSettings laser = limited(40, 0.1);
  laser.noise.range_sigma = 3.0;
  add_eye(world, {}, laser);
  EXPECT_EQ(flags_of(Glance(world).readings[0]), std::vector(40, too_near));
}

/// Between two hits beyond the minimum, a flat wall may be nearer than the minimum, and so may the line between them.
TEST(RangeLimits, ChordMayBeTooNear) {
  world::World world = wall_between(0.45);
  add_eye(world, {}, limited(3, 1.2));
  sensors::set_accuracy(world, "skip2");
  const Glance glance(world);
  EXPECT_EQ(glance.readings[0].values[1], kMin);
  EXPECT_EQ(flags_of(glance.readings[0]), (std::vector{none, too_near, none}));
}

/// A sample between two cast beams is too near if the nearer of the two is.
TEST(RangeLimits, InterpolatedSamplesTakeTheFlagOfTheNearerBeam) {
  world::World world = wall_between(0.3, -5.0, -0.01);
  add_eye(world, {}, limited(5, 0.4, 4));
  EXPECT_EQ(flags_of(Glance(world).readings[0]), (std::vector{too_near, too_near, not_cast, not_cast, none}));
}

TEST(RangeLimits, FlagsBelongToTheNewestScan) {
  for (const std::uint32_t resolution : {1u, 4u}) {
    world::World world = wall_between(2.0);
    add_eye(world, {}, limited(5, 0.4, resolution));
    farm::Farm farm(world, device(), {});
    farm.subscribe_all();
    const QualityFlag between = resolution > 1 ? not_cast : none;
    for (int tick = 0; tick < 4; ++tick) {
      const bool near = tick % 2 == 0;
      const base::Report report{0, tick * 100'000'000, {near ? 1.8 : 0.0, 0.0, 0.0, 0.0}, {}};
      const auto readings = farm.tick(report.time, {&report, 1});
      ASSERT_EQ(readings.size(), 1u);
      EXPECT_EQ(flags_of(readings[0]),
                near ? std::vector(5, too_near) : (std::vector{none, between, between, between, none}));
    }
  }
}

TEST(RangeLimits, NothingIsTooNearWithoutAMinimum) {
  world::World world = wall_between(0.0);
  add_eye(world, {}, eye(3, 0.2, kMax));
  const Glance glance(world);
  EXPECT_EQ(glance.readings[0].values[1], 0.0);
  EXPECT_EQ(glance.readings[0].hits[1], world.walls[0].model);
  EXPECT_TRUE(glance.readings[0].quality.empty());
}

// --- Sonar and infrared.

TEST(RangeLimits, OfSonarAndInfrared) {
  for (const std::string type : {"sonar", "infrared"})
    for (const Case& c : kCases) {
      world::World world = wall_between(c.wall);
      add_ranger(world, {}, cones(type, {Pose{}}, {cone_setting("range", {kMin, kMax})}));
      const Glance glance(world);
      const double range = glance.readings[0].values[0];
      EXPECT_NEAR(range, c.range, 1e-15) << type << ": " << c.why;
      EXPECT_EQ(range == kMax, !c.named) << type << ": " << c.why;
      EXPECT_EQ(flag_of(glance.readings[0], 0), c.flag) << type << ": " << c.why;
    }
}

/// A transducer that does not fire keeps its flag and its range.
TEST(RangeLimits, OfTransducersThatFireInTurn) {
  world::World world = wall_between(2.0);
  add_ranger(world, {}, cones("sonar", {Pose{}, Pose{}}, {cone_setting("range", {kMin, kMax})}));
  farm::Farm farm(world, device(), {});
  farm.subscribe_all();
  const std::vector<QualityFlag> expected[] = {{too_near, too_near}, {too_near, none}, {none, none}};
  for (int tick = 0; tick < 3; ++tick) {
    const base::Report report{0, tick * 40'000'000, {tick == 0 ? 1.8 : 0.0, 0.0, 0.0, 0.0}, {}};
    const auto readings = farm.tick(report.time, {&report, 1});
    ASSERT_EQ(readings.size(), 1u);
    EXPECT_EQ(flags_of(readings[0]), expected[tick]) << tick;
  }
}

}  // namespace
}  // namespace sf::trial
