// Cut-offs: magnets included, error, and its stated bound.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "sensors/magnetic_field/magnet_tree.h"
#include "sensors/magnetic_field/truncation.h"
#include "tests/instrumented.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/field_on_both.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

using scenes::magnet;
using sensors::FieldPoint;

// --- Which magnets count.

/// The distance is along the ground, at any height. A magnet at exactly the cut-off counts; one ulp farther away it
/// does not.
TEST(MagnetCutoff, IsSharpAndAlongTheGround) {
  world::World world;
  world.magnets.push_back(magnet({0, 0}));
  world.magnet_cutoff = 2.0;
  EXPECT_NE(field_at(world, {2.0, 0, 0.1}).z, 0.0);
  EXPECT_NE(field_at(world, {0, -2.0, 100.0}).z, 0.0);
  EXPECT_EQ(field_at(world, {std::nextafter(2.0, 3.0), 0, 0.1}).z, 0.0);
  EXPECT_EQ(field_at(world, {1.5, 1.5, 0.0}).z, 0.0);
}

/// Compares with a sum over exactly the magnets within the cut-off, at points and cut-offs of all sizes.
TEST(MagnetCutoff, SumsTheMagnetsWithinIt) {
  Chance chance(5);
  for (const double cutoff : {0.05, 0.5, 3.0, 30.0})
    for (const double offset : {0.0, 1e5}) {
      world::World world = scenes::sheet(3000, 20.0, 6, true);
      for (world::Magnet& m : world.magnets) m.p = m.p + glm::dvec2{offset, offset};
      world.magnet_cutoff = cutoff;
      std::vector<FieldPoint> points;
      for (int i = 0; i < 250; ++i)
        points.push_back({offset + chance.between(-12, 12), offset + chance.between(-12, 12), 0.1});
      const auto sums = sample_on_both(world, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const scenes::Exact truth = scenes::exact(world, points[i], cutoff);
        ASSERT_LE(scenes::apart(truth, sums[i]), 1e-7 * static_cast<double>(truth.magnitudes))
            << cutoff << ", point " << i;
      }
    }
}

// --- The bound.

/// Contribution of one magnet beyond the cut-off: compares the formula with the field, and checks its decrease with
/// distance and height.
TEST(MagnetBound, OneMagnet) {
  Chance chance(7);
  for (int i = 0; i < 500; ++i) {
    const double along = chance.between(0.1, 10), above = chance.between(0, 10);
    world::World world;
    world.magnets.push_back(magnet({0, 0}));
    const double field = static_cast<double>(scenes::exact(world, {along, 0, above}).magnitudes);
    EXPECT_NEAR(sensors::field_beyond(1e-7, along, above), field, 1e-12 * field);
    EXPECT_LE(sensors::field_beyond(1e-7, 1.1 * along, above), field);
    EXPECT_LE(sensors::field_beyond(1e-7, along, above + 0.1), field * (1 + 1e-12));
  }
}

struct Measured {
  double bound = 0.0;  ///< [T]
  double worst = 0.0;  ///< [T] |B - B_cut|
};

/// Measures points all over the world, outside it, at the cut-off distance of magnets, and at the maximum of the bound.
Measured measure(world::World world, double half, double height, std::uint32_t count) {
  Chance chance(9);
  std::vector<FieldPoint> points;
  const double cutoff = world.magnet_cutoff;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::dvec2 p = chance.in_square(half + 1.2 * cutoff);
    const glm::dvec2 m = world.magnets[chance.below(static_cast<std::uint32_t>(world.magnets.size()))].p;
    const double a = chance.between(-M_PI, M_PI), r = cutoff * chance.between(0.999, 1.01);
    const bool at_rim = i % 2 == 0;
    points.push_back({at_rim ? m.x + r * std::cos(a) : p.x, at_rim ? m.y + r * std::sin(a) : p.y, height});
  }
  const auto cut = sample_on_both(world, points);
  Measured result{sensors::truncation_bound(world, height), 0.0};
  world.magnet_cutoff = 0.0;
  const auto all = sample_on_both(world, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    result.worst = std::max(result.worst, std::hypot(all[i].x - cut[i].x, all[i].y - cut[i].y, all[i].z - cut[i].z));
  return result;
}

const std::uint32_t kPlaces = instrumented() ? 2'000 : 25'000;

/// @param most largest permitted ratio of the bound to the largest error found
void expect_bounded(const std::string& name, const world::World& world, double half, double height, double most) {
  const Measured m = measure(world, half, height, kPlaces);
  std::cout << "[ measured ] " << name << ": the cut-off leaves out up to " << m.worst << " T, the bound is " << m.bound
            << " T, " << m.bound / m.worst << " times that\n";
  EXPECT_GT(m.worst, 0.0) << name;
  EXPECT_LE(m.worst, m.bound) << name;
  EXPECT_LE(m.bound, most * m.worst) << name;
}

TEST(MagnetBound, HoldsOnALine) {
  world::World world = scenes::line(400, 0.071);
  world.magnet_cutoff = 1.0;
  expect_bounded("400 in a line, 1 m", world, 15.0, 0.125, 4.0);
}

TEST(MagnetBound, HoldsOnASheet) {
  world::World world;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) world.magnets.push_back(magnet({i - 29.5, j - 29.5}));
  world.magnet_cutoff = 8.0;
  expect_bounded("60 x 60 in a square, 8 m", world, 30.0, 0.2, 4.0);
}

TEST(MagnetBound, HoldsForRandomMagnetsInBothOrientations) {
  world::World world = scenes::sheet(1500, 30.0, 10, true);
  world.magnet_cutoff = 3.0;
  expect_bounded("1500 at random, either way up, 3 m", world, 15.0, 0.3, 100.0);
}

/// Two clusters far apart, and one single magnet: most of the world is empty.
TEST(MagnetBound, HoldsInAMostlyEmptyWorld) {
  world::World world = scenes::sheet(50, 0.5, 11);
  for (int i = 0; i < 20; ++i) world.magnets.push_back(magnet({3000.0 + 0.01 * i, 4000.0}, 0.0, 5.0));
  world.magnets.push_back(magnet({-700.0, 20.0}, 0.0, -0.1));
  world.magnet_cutoff = 0.7;
  expect_bounded("two clusters 5 km apart, 0.7 m", world, 1.0, 0.0, 20.0);
}

/// A sensor just outside the cut-off of a single magnet misses all of its field.
TEST(MagnetBound, EqualsTheFieldOfOneMagnetAtTheCutoff) {
  world::World world;
  world.magnets.push_back(magnet({5, 5}));
  world.magnet_cutoff = 2.0;
  for (const double height : {0.0, 0.3, 5.0}) {
    const double field = sensors::field_beyond(1e-7, 2.0, height);
    EXPECT_GE(sensors::truncation_bound(world, height), field);
    EXPECT_LE(sensors::truncation_bound(world, height), 1.0001 * field);
  }
}

/// Magnets that are summed as one are assumed to be at the height of the nearest of them.
TEST(MagnetBound, UsesTheNearerOfTwoHeights) {
  world::World world;
  world.magnets = {magnet({0, 0}), magnet({0.01, 0}, -5.0)};
  world.magnet_cutoff = 2.0;
  EXPECT_GE(sensors::truncation_bound(world, 0.1), sensors::field_beyond(1e-7, 2.0, 0.1));
}

TEST(MagnetBound, IsZeroWithoutACutoffOrMagnets) {
  world::World world = scenes::line(10, 0.1);
  EXPECT_EQ(sensors::truncation_bound(world, 0.1), 0.0);
  world.magnets.clear();
  world.magnet_cutoff = 1.0;
  EXPECT_EQ(sensors::truncation_bound(world, 0.1), 0.0);
}

/// Movers' magnets may be anywhere, so all of them count at the cut-off distance at once.
TEST(MagnetBound, CountsMovingMagnetsAtTheCutoff) {
  world::World world;
  scenes::add_carrier(world, {0, 0, 0.5, 0}, scenes::five());
  world.movers[0].magnets = {magnet({0.1, 0.0}, 0.2), magnet({-0.1, 0.0}, 0.2, -3.0)};
  world.magnet_cutoff = 2.0;
  EXPECT_NEAR(sensors::truncation_bound(world, 0.4), sensors::field_beyond(4e-7, 2.0, 0.3),
              1e-5 * sensors::field_beyond(4e-7, 2.0, 0.3));
}

TEST(MagnetBound, SummaryIsForTheWorstElement) {
  world::World world = scenes::line(100, 0.1);
  world.magnet_cutoff = 1.5;
  const sensors::MagnetSummary without_sensors = sensors::summarize_magnets(world);
  EXPECT_EQ(without_sensors.magnets, 100u);
  EXPECT_EQ(without_sensors.moving_magnets, 0u);
  EXPECT_EQ(without_sensors.cutoff_m, 1.5);
  EXPECT_GE(without_sensors.bound_T, sensors::truncation_bound(world, 0.0));

  scenes::add_carrier(world, {0, 0, 0.1, 0}, scenes::array({{0, 0, 0.5, 0}, {0, 0, 0.2, 0}}, 0.1));
  world.movers[0].magnets = {magnet({0, 0}, -0.5, 1e-9)};
  const sensors::MagnetSummary with_sensor = sensors::summarize_magnets(world);
  EXPECT_EQ(with_sensor.moving_magnets, 1u);
  EXPECT_DOUBLE_EQ(with_sensor.height_m, 0.1 + 0.1 + 0.2);
  EXPECT_EQ(with_sensor.bound_T, sensors::truncation_bound(world, with_sensor.height_m));
  EXPECT_LE(with_sensor.bound_T, without_sensors.bound_T * 1.0001);
}

}  // namespace
}  // namespace sf::trial
