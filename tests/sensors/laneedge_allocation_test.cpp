// A warm tick of lane edge sensors does not allocate. The test replaces `operator new` and counts calls of the calling
// thread only, because the Vulkan driver's threads may allocate.

#include <gtest/gtest.h>

#include "tests/counted_new.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

std::uint64_t allocations_per_lap(const world::World& world) {
  EdgeRig rig(world);
  std::vector<base::Pose> poses;
  for (const world::Mover& mover : world.movers) poses.push_back(mover.X_WM);
  std::vector<sensors::DueSample> all;
  std::vector<sensors::DueSample> some;
  for (std::uint32_t row = 0; row + 1 < world.movers.size(); ++row) {
    all.push_back({row, row});
    if (row % 2 == 0) some.push_back({row, row});
  }
  return counted::when_warm(60, [&] {
    rig.tick(all, poses);
    rig.tick(some, poses);
  });
}

/// Exact and in pixels, with noise, distinguishable dashes, and a robot in the way.
TEST(LaneEdgeAllocation, WarmTicksDoNotAllocate) {
  for (const double h : {0.0, 0.01}) {
    world::World world;
    world.road_resolution = h;
    add_dashes(world, {-3.0, 0.0}, {3.0, 0.0}, 0.05, 0.2, 0.2);
    world.lane_markings.push_back(marking({-3.0, 0.2}, {3.0, 0.2}));
    for (int i = 0; i < 40; ++i)
      add_edge_eye(world, {-2.0 + 0.1 * i, -0.3, 0.0, 1.3}, {{"perpendicular", {0}}, {"noise", {0.002, 0.001, 0.1}}});
    scenes::add_robot(world, {0.0, -0.2, 0.0, 0.0}, scenes::laser());
    EXPECT_EQ(allocations_per_lap(world), 0u) << h;
  }
}

}  // namespace
}  // namespace sf::trial
