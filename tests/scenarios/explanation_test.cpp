// Cost of a world in the farm.

#include "scenarios/explanation.h"
#include "raycast/casters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "farm/farm.h"
#include "tests/device.h"
#include "tests/sensors/scenes.h"

namespace sf::scenarios {
namespace {

world::World lasers(std::uint32_t robots) {
  world::World world = scenes::boxes(20, 8.0, 3);
  scenes::add_robots(world, robots, scenes::laser(61, M_PI, 4.0), 5);
  world.walls.push_back(world.walls.front());
  world.walls.back().z_min = 5.0;
  world.walls.back().z_max = 6.0;
  world::update_extent_and_hash(world);
  return world;
}

TEST(Explanation, CountsSensorsRobotsAndKernels) {
  const world::World world = lasers(6);
  const Explanation e = explain(world, device(), 1, 1);
  ASSERT_EQ(e.types.size(), 1u);
  const SensorTypeCost& k = e.types[0];
  EXPECT_EQ(k.type, "laser");
  EXPECT_EQ(k.sensors, 6u);
  EXPECT_EQ(k.robots, 6u);
  EXPECT_EQ(k.most_rate, 10.0);
  EXPECT_DOUBLE_EQ(k.readings, 6.0) << "10 Hz in ticks of 0.1 s";
  EXPECT_EQ(k.work.rays, std::llround((6.0 - k.reused) * 61.0 * static_cast<double>(e.ticks)));
  EXPECT_LT(k.reused, 1.0) << "they drive";
  const bool software = device().info().software;
  EXPECT_EQ(e.caster.rfind(software ? "host, " : "Vulkan kernels", 0), 0u) << e.caster;
  EXPECT_EQ(k.kernels.empty(), software) << "a software device runs no kernels";
  std::size_t sum = 0;
  for (const gpu::DeviceAllocation& h : k.tables) sum += h.bytes;
  EXPECT_EQ(k.bytes, sum);
  EXPECT_TRUE(std::any_of(k.tables.begin(), k.tables.end(), [](const auto& h) { return h.name == "ranges"; }));
  EXPECT_GT(e.resident, 1u << 20);
}

/// A tag at rest: its laser is alone in the room.
TEST(Explanation, ReusedReadingsAreCounted) {
  world::World world;
  scenes::add_room(world, {}, 20.0);
  scenes::add_robot(world, {}, scenes::laser(61, M_PI, 4.0));
  world.movers[0].is_tag = true;
  const Explanation e = explain(world, device(), 1, 1);
  ASSERT_EQ(e.types.size(), 1u);
  EXPECT_EQ(e.types[0].readings, 1.0);
  EXPECT_EQ(e.types[0].reused, 1.0);
  EXPECT_EQ(e.types[0].work.rays, 0u);
}

/// Six robots in a row face along it: each sees its neighbours, which hide the others.
TEST(Explanation, HiddenMoversAreCounted) {
  world::World world;
  for (int i = 0; i < 6; ++i) scenes::add_robot(world, {0.5 * i, 0.0, 0.0, 0.1}, scenes::laser(61, 2.0 * M_PI, 4.0));
  world::update_extent_and_hash(world);
  farm::Farm farm(world, device(), {.scene = {.caster = &raycast::host_caster}});
  farm.subscribe_all();
  farm.tick(0, {});
  EXPECT_EQ(farm.stats().work.movers_in_range, 6u * 5u);
  EXPECT_EQ(farm.stats().work.movers_visible, 2u * 5u) << "both neighbours, one at the ends";
}

/// A range of 4 m reaches from (0, 0) to (2.828, 2.828).
TEST(Explanation, SmallMoversBeyondTheRangeAreNotCounted) {
  for (const double at : {2.82, 2.84}) {
    world::World world;
    for (const double x : {0.0, at}) scenes::add_robot(world, {x, x, 0.0, 0.0}, scenes::laser(61, 2.0 * M_PI, 4.0));
    for (world::Mover& mover : world.movers) {
      for (world::Segment& s : mover.body) s.a *= 1e-4 / mover.radius, s.b *= 1e-4 / mover.radius;
      mover.radius = 1e-4;
      mover.sensors[0].X_MS = {};
    }
    world::update_extent_and_hash(world);
    farm::Farm farm(world, device(), {.scene = {.caster = &raycast::device_caster}});
    farm.subscribe_all();
    farm.tick(0, {});
    EXPECT_EQ(farm.stats().work.movers_in_range, at < 2.828 ? 2u : 0u) << at;
  }
}

TEST(Explanation, StatesModesAndBounds) {
  world::World world = lasers(2);
  sensors::set_accuracy(world, "skip2");
  const Explanation e = explain(world, device(), 1, 1);
  ASSERT_EQ(e.statements.size(), 1u);
  EXPECT_EQ(e.statements[0].mode, 2);
  EXPECT_LT(e.statements[0].bound.error, 2e-9);
}

TEST(Explanation, WallsOutOfReachOfLasersAreNotCounted) {
  const world::World world = lasers(2);
  const Explanation e = explain(world, device(), 1, 1);
  ASSERT_EQ(e.slices.size(), 1u);
  EXPECT_EQ(e.slices[0].walls, world.walls.size() - 1);
  EXPECT_EQ(e.slices[0].sensors, 2u);
}

TEST(Explanation, AMissingSensorTypeIsNotBuilt) {
  const Explanation e = explain(lasers(2), device(), 1, 1);
  EXPECT_EQ(e.absent.size(), sensors::sensor_types().size() - 1);
  EXPECT_EQ(std::count(e.absent.begin(), e.absent.end(), "magnetometer"), 1);
  for (const gpu::DeviceAllocation& h : device().allocations()) EXPECT_EQ(h.owner, "") << "no allocation remains";
}

}  // namespace
}  // namespace sf::scenarios
