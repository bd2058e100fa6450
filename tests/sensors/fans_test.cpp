// Every width of fan and number of samples.

#include <gtest/gtest.h>

#include "raycast/beams.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

constexpr double kDegree = M_PI / 180.0;

TEST(Fans, EveryWidthAndCount) {
  world::World world = scenes::boxes(30, 16.0, 2);
  Chance chance(1);
  for (const double fov : {0.0, 1e-6, 1e-3, 10 * kDegree, 180 * kDegree, 270 * kDegree, 360 * kDegree})
    for (const std::uint32_t samples : {1, 2, 3, 4, 5, 6, 7, 8, 31, 33, 64, 65, 361, 1001}) {
      const base::Vec2 p = chance.in_square(7.0);
      add_eye(world, {p.x, p.y, 0.0, chance.between(-10.0, 10.0)}, eye(samples, fov, 8.0));
    }
  expect_exact("fans", sweep(world));
}

TEST(Fans, AHundredThousandSamples) {
  world::World world = scenes::boxes(30, 16.0, 2);
  for (const double fov : {1e-6, 180 * kDegree, 360 * kDegree})
    add_eye(world, {0.1, 0.2, 0, 1.0}, eye(100'000, fov, 100.0));
  const Glance run(world);
  for (const auto& reading : run.readings) EXPECT_EQ(reading.values.size(), 100'000u);
  expect_exact("100 000 samples", sweep(world));
}

/// A heading of many turns, and each heading at which a beam falls on the border of two direction sectors.
TEST(Fans, EveryHeading) {
  world::World world = scenes::boxes(30, 16.0, 2);
  for (int i = -40; i < 40; ++i) {
    add_eye(world, {0.3, 0.2, 0.0, i * M_PI / 32}, eye(33, M_PI, 30.0));
    add_eye(world, {0.3, 0.2, 0.0, i * M_PI / 32 + 1e-9}, eye(5, 2.0 * M_PI, 30.0));
    add_eye(world, {0.3, 0.2, 0.0, 1000.0 * i}, eye(5, 1.0, 30.0));
  }
  expect_exact("headings", sweep(world));
}

TEST(Fans, SymmetricWorldGivesASymmetricScan) {
  world::World world;
  scenes::add_outline(world, {{2, -1}, {3, -1}, {3, 1}, {2, 1}}, "box");
  add_eye(world, {}, eye(362, M_PI, 8.0));
  const Glance run(world);
  const auto values = run.readings[0].values;
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], values[values.size() - 1 - i], 1e-12);
}

}  // namespace
}  // namespace sf::trial
