// Every caster of the table supports every sensor type: readings are equal, or agree within the bounds of both casters.

#include "raycast/casters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

/// Lasers with noise, skipped beams and a minimum, at two heights; sonar, infrared, edges of a road, lidars and
/// cameras.
world::World mixed() {
  world::World world = scenes::boxes(20, 8.0, 3);
  world.lane_markings.push_back(marking({8.0, 0.1}, {-8.0, 0.1}));
  sensors::LaserSettings laser = scenes::laser(91, 1.7 * M_PI, 5.0);
  scenes::add_robots(world, 4, laser, 3);
  laser.noise = {.range_sigma = 0.01, .range_proportional = 0.01, .angle_sigma = 0.01};
  laser.range_min = 0.3;
  laser.resolution = 3;
  scenes::add_robots(world, 4, laser, 4);
  scenes::edit_laser(world.movers[2])->X_MS.z += 0.4;
  add_ranger(world, {0.3, -0.4, 0.0, 0.2}, cones("sonar", ring(6, 0.15), {cone_setting("incidence", {0.6})}), 0.16);
  add_ranger(world, {-0.6, 0.5, 0.0, 2.0}, cones("infrared", ring(5, 0.15)), 0.16);
  add_ranger(
      world, {0.2, 0.9, 0.0, 1.0},
      {.type = "lidar",
       .name = "lidar",
       .height = 0.2,
       .settings = {cone_setting("channels", {8}), cone_setting("columns", {90}), cone_setting("fov_v", {-0.4, 0.3}),
                    cone_setting("range", {0.0, 20.0}), cone_setting("intensity", {1}), cone_setting("returns", {2}),
                    cone_setting("divergence", {0.003}), cone_setting("beam_parts", {4})}},
      0.2);
  add_ranger(world, {-0.4, -0.9, 0.0, 3.0},
             {.type = "camera",
              .name = "camera",
              .height = 0.2,
              .settings = {cone_setting("resolution", {24, 18}), cone_setting("range", {0.0, 20.0}),
                           cone_setting("normals", {1})}},
             0.2);
  for (int i = 0; i < 3; ++i) add_edge_eye(world, {0.5 * i - 0.7, -0.25 - 0.02 * i, 0.0, M_PI / 2.0});
  return world;
}

class EveryCaster : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Casters, EveryCaster, testing::ValuesIn(raycast::caster_words()),
                         [](const auto& name) { return name.param; });

/// Robots move. One of them leaves and returns.
TEST_P(EveryCaster, MatchesTheHostForEverySensorType) {
  const world::World world = mixed();
  const raycast::CasterType* const type = raycast::caster_named(GetParam());
  farm::Farm host(world, device(), {.seed = 4, .scene = {.caster = &raycast::host_caster}});
  farm::Farm own(world, device(), {.seed = 4, .scene = {.caster = type}});
  const bool same_bytes = raycast::choose_caster(device().info().software, type).same_bytes;
  host.subscribe_all(), own.subscribe_all();
  Chance chance(8);
  double largest = 0.0;
  for (int tick = 0; tick < 3; ++tick) {
    host.set_absent(1, tick == 1), own.set_absent(1, tick == 1);
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      base::Pose X = world.movers[m].X_WM;
      X.x += chance.between(-0.02, 0.02), X.yaw += chance.between(-0.3, 0.3);
      if (m == 1 && tick == 1) X = base::kAbsent;
      reports.push_back({m, 0, X, {}});
    }
    const auto expected = host.tick(tick * 1'000'000'000ll, reports), given = own.tick(tick * 1'000'000'000ll, reports);
    if (same_bytes) expect_same_bits(expected, given);
    ASSERT_EQ(expected.size(), given.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      const base::ReadingBlock &a = expected[i], &b = given[i];
      ASSERT_EQ(a.values.size(), b.values.size());
      EXPECT_TRUE(std::ranges::equal(a.hits, b.hits)) << "type " << int{a.type} << ", mover " << a.mover;
      EXPECT_TRUE(std::ranges::equal(a.quality, b.quality)) << "type " << int{a.type} << ", mover " << a.mover;
      const double bound = a.type == sensors::kLaser ? 1.1 * (a.bound_without_noise + b.bound_without_noise) : 1e-7;
      for (std::size_t k = 0; k < a.values.size(); ++k) {
        const double apart = std::isnan(a.values[k]) ? 0.0 : std::abs(a.values[k] - b.values[k]);
        EXPECT_EQ(std::isnan(a.values[k]), std::isnan(b.values[k]));
        EXPECT_LE(apart, bound) << "type " << int{a.type} << ", mover " << a.mover << ", value " << k;
        largest = std::max(largest, apart);
      }
    }
  }
  EXPECT_EQ(largest == 0.0, same_bytes) << "other casters have other bytes";
}

/// A reading carries the bound of its caster.
TEST_P(EveryCaster, StatesItsBound) {
  world::World world;
  scenes::add_room(world, {}, 6.0);
  add_eye(world, {}, eye(5, M_PI, 20.0));
  const raycast::CasterType* const type = raycast::caster_named(GetParam());
  const Glance glance(world, {.scene = {.caster = type}});
  const raycast::CasterType& chosen = raycast::choose_caster(device().info().software, type);
  const double longest = sensors::reaches_of(world).longest;
  EXPECT_EQ(glance.readings[0].bound, chosen.bound(20.0, longest, 20.0));
  EXPECT_LE(glance.readings[0].bound, sensors::laser_bound(20.0, false, longest, 20.0)) << "the stated one";
}

TEST(Casters, HaveTheNamesOfTheTable) {
  EXPECT_EQ(raycast::caster_words(), (std::vector<std::string>{"auto", "vulkan", "host", "reference"}));
  EXPECT_EQ(raycast::caster_named("auto"), nullptr);
  for (const raycast::CasterType* type : raycast::casters()) EXPECT_EQ(raycast::caster_named(type->name), type);
  EXPECT_EQ(&raycast::choose_caster(false, &raycast::reference_caster), &raycast::reference_caster);
  const std::string refusal = refusal_of<base::InputError>([] { raycast::caster_named("refrence"); });
  EXPECT_EQ(refusal,
            "there is no caster 'refrence'; did you mean 'reference'? Expected one of: auto, vulkan, host, reference");
}

}  // namespace
}  // namespace sf::trial
