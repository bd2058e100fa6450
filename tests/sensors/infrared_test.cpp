// Infrared proximity: responses and ranges, analytically and ray by ray.

#include "sensors/infrared.h"

#include <gtest/gtest.h>

#include "raycast/casters.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using base::Pose;

struct Response {
  double range, value;
};

/// Returns the response to a wall `gap` [m] ahead of one element.
Response see(double gap, std::vector<world::Setting> more = {}) {
  world::World world;
  scenes::add_outline(world, {{gap, -1}, {gap + 1, -1}, {gap + 1, 1}, {gap, 1}}, "wall");
  add_ranger(world, {}, cones("infrared", {Pose{}}, std::move(more)));
  const Glance run(world);
  EXPECT_EQ(run.readings[0].type, sensors::kInfrared);
  EXPECT_EQ(run.readings[0].values.size(), 2u);
  return {run.readings[0].values[0], run.readings[0].values[1]};
}

TEST(Infrared, ResponseFallsLinearly) {
  for (int k = 0; k <= 60; ++k) {
    const double gap = 1e-3 * k + 1e-7;
    const Response r = see(gap);
    EXPECT_NEAR(r.range, std::min(gap, 0.05), 1e-12) << k;
    EXPECT_EQ(r.value, std::floor(1023.0 * (1.0 - std::min(gap, 0.05) / 0.05) + 0.5)) << k;
  }
}

TEST(Infrared, SaturatesBelowRangeMin) {
  const std::vector<world::Setting> range{cone_setting("range", {0.01, 0.03})};
  EXPECT_EQ(see(0.005, range).value, 1023.0);
  EXPECT_EQ(see(0.005, range).range, 0.01);
  EXPECT_EQ(see(0.0175, range).value, 639.0) << "639.375";
  EXPECT_EQ(see(0.04, range).value, 0.0);
}

/// Light returns from any angle: the reading is the nearest of eleven rays in 30 degrees, at any incidence.
TEST(Infrared, DetectsAWallAtAnyIncidence) {
  for (int degrees = -60; degrees <= 60; degrees += 5) {
    world::World world;
    scenes::add_outline(world, {{0.02, -9}, {1, -9}, {1, 9}, {0.02, 9}}, "wall");
    add_ranger(world, {}, cones("infrared", {{0, 0, 0, degrees * kDegree}}));
    double expected = 0.05;
    for (int i = -5; i <= 5; ++i) expected = std::min(expected, 0.02 / std::cos((degrees + 3 * i) * kDegree));
    EXPECT_NEAR(Glance(world).readings[0].values[0], expected, 1e-12) << degrees;
  }
}

/// Two Kheperas side by side: each detects the other and never itself.
TEST(Infrared, DetectsOtherRobotsButNotItsOwn) {
  world::World world;
  add_ranger(world, {}, cones("infrared", ring(8, 0.03)), 0.035);
  add_ranger(world, {0.09, 0, 0, 0}, cones("infrared", ring(8, 0.03)), 0.035);
  const Glance run(world);
  EXPECT_LT(run.readings[0].values[0], 0.027);
  EXPECT_GT(run.readings[0].values[0], 0.024);
  for (std::size_t i = 2; i <= 6; ++i) EXPECT_EQ(run.readings[0].values[2 * i], 0.05) << i;
  EXPECT_EQ(run.readings[1].values[8], run.readings[0].values[0]) << "they face each other";
}

TEST(Infrared, EveryConeReadsTheNearestOfItsRays) {
  world::World world = scenes::boxes(40, 2.0, 7);
  Chance chance(1);
  for (int m = 0; m < 60; ++m) {
    const glm::dvec2 p = chance.in_square(0.9);
    add_ranger(world, {p.x, p.y, 0.0, chance.between(-9, 9)}, cones("infrared", ring(8, 0.03)), 0.035);
  }
  const auto arrays = sensors::cone_arrays_of(world, "infrared", sensors::read_infrared);
  for (const raycast::CasterType* caster : raycast::casters()) {
    const Glance run(world, {.scene = {.caster = caster}});
    const ConeTally tally = compare_cones(world, loaded_poses(world), run.readings, arrays, 2);
    EXPECT_EQ(tally.cones, 480u);
    EXPECT_EQ(tally.wrong, 0u) << caster->name << ": " << tally.example;
    EXPECT_LE(tally.worst, 1e-9) << caster->name;
    EXPECT_GT(tally.met, 100u);
    EXPECT_LT(tally.met, 450u);
  }
}

TEST(Infrared, EveryReadingUsesAllElements) {
  world::World world;
  add_ranger(world, {}, cones("infrared", ring(8, 0.03)));
  farm::Farm farm(world, device(), {.reuse_unchanged = false});
  farm.subscribe_all();
  for (int k = 0; k < 5; ++k) EXPECT_EQ(farm.tick(k * 20'000'000ll, {}).size(), 1u) << "50 Hz";
  EXPECT_EQ(farm.stats().work.rays, 5u * 8u * 11u);
}

}  // namespace
}  // namespace sf::trial
