// Any message of the Vulkan validation layer is an error.

#include <gtest/gtest.h>

#include <cstdlib>

#include "raycast/casters.h"
#include "tests/farm/small_farm.h"
#include "tests/sensors/cone_scenes.h"

namespace sf::farm {
namespace {

TEST(Validation, LayerReportsNothing) {
  setenv("SENSORFARM_VALIDATE", "1", 1);
  {
    gpu::Device device;
    if (device.validation_messages().find("not installed") != std::string::npos)
      GTEST_SKIP() << "the validation layer is not installed";
    world::World world = small_world(20, {.range_sigma = 0.01, .angle_sigma = 0.001});
    for (world::Mover& mover : world.movers)
      for (const char* type : {"sonar", "infrared"})
        mover.sensors.push_back(trial::cones(type, trial::ring(8, 0.1), {trial::cone_setting("range", {0, 1})}));
    Farm farm(world, device,
              {.scene = {.caster = &raycast::device_caster,
                         .pool_chunks = 1024,
                         .pool_cells = 8}});  // so small that its tables are replaced
    farm.subscribe_all();
    for (int k = 0; k < 4; ++k) farm.tick(k * 100'000'000ll, reports_at(world, k));
    EXPECT_GT(farm.stats().readings, 0u);
    EXPECT_EQ(device.validation_messages(), "");
  }
  unsetenv("SENSORFARM_VALIDATE");
}

}  // namespace
}  // namespace sf::farm
