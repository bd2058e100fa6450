// A tick with magnetometers causes no messages of the validation layer, even when its tables are replaced.

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/farm/small_farm.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::trial {
namespace {

/// Robots with arrays and magnets of their own, among static magnets.
world::World park(double cutoff) {
  world::World world = scenes::sheet(400, 6.0, 1, true);
  world.magnet_cutoff = cutoff;
  Chance chance(2);
  for (int i = 0; i < 30; ++i) {
    world::Sensor sensor = scenes::five();
    sensor.settings.push_back(scenes::setting("noise", {0.01}));
    const auto m = scenes::add_carrier(world, {chance.between(-3, 3), chance.between(-3, 3), 0, 0}, sensor);
    world.movers[m].magnets.push_back(scenes::magnet({-0.1, 0.0}, 0.05));
  }
  return world;
}

/// Magnets of an absent robot are also absent, as in a world without them.
TEST(MagnetTick, AbsentRobotHasNoMagnets) {
  for (const double cutoff : {0.0, 1.5}) {
    const world::World world = park(cutoff);
    world::World without = world;
    for (std::uint32_t m = 20; m < 30; ++m) without.movers[m].magnets.clear();
    farm::Farm farm(world, device()), bare(without, device());
    for (std::uint32_t m = 0; m < 30; ++m) farm.set_absent(m, m >= 20);
    for (std::uint32_t m = 0; m < 20; ++m)
      farm.subscribe(m, farm::kAllSensorTypes), bare.subscribe(m, farm::kAllSensorTypes);
    const auto gone = farm.tick(0, {}), never = bare.tick(0, {});
    ASSERT_EQ(gone.size(), 20u);
    for (std::size_t i = 0; i < gone.size(); ++i)
      for (std::size_t k = 0; k < gone[i].values.size(); ++k)
        EXPECT_NEAR(gone[i].values[k], never[i].values[k], 1e-15) << i << ", " << k;
  }
}

TEST(MagnetTick, ValidationLayerIsSilent) {
  setenv("SENSORFARM_VALIDATE", "1", 1);
  {
    gpu::Device device;
    if (device.validation_messages().find("not installed") != std::string::npos)
      GTEST_SKIP() << "the validation layer is not installed";
    for (const double cutoff : {0.0, 1.5}) {
      const world::World world = park(cutoff);
      farm::Farm farm(world, device);
      for (int k = 0; k < 4; ++k) {
        // More and more robots are subscribed, so that tables are replaced.
        for (std::uint32_t m = 0; m < 30; ++m)
          farm.subscribe(m, static_cast<int>(m) < 10 * k ? farm::kAllSensorTypes : 0u);
        farm.tick(k * 100'000'000ll, farm::reports_at(world, k));
      }
      EXPECT_EQ(farm.stats().readings, 60u);
      EXPECT_EQ(device.validation_messages(), "");
    }
  }
  unsetenv("SENSORFARM_VALIDATE");
}

}  // namespace
}  // namespace sf::trial
