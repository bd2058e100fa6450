// Tilted robots: in ticks, between them, and where readings are reused.

#include <gtest/gtest.h>

#include <vector>

#include "robots/kinematics.h"
#include "tests/sensors/series.h"
#include "tests/units.h"

namespace sf::farm {
namespace {

constexpr const char* kScene =
    "define robot position( size [0.4 0.4 0.5] origin [0 0 0 0] )\n"
    "model( name \"wall\" pose [4 0 0 10] size [0.2 12 3] )\n"
    "robot( name \"r1\" pose [0 0 0 20] lidar( channels 8 columns 90 rate 4 ) )\n"
    "robot( name \"r2\" pose [2 0.5 0 30] )\n";

struct Scene {
  world::World world = trial::world_of(kScene);
  Farm farm{world, device(), {.noise = false}};
  std::vector<base::Report> states;
  std::int64_t now = 0;

  Scene() {
    for (std::uint32_t m = 0; m < 2; ++m) states.push_back({.mover = m, .X_WM = world.movers[m].X_WM});
    farm.subscribe_all();
  }
  std::vector<double> tick() {
    for (base::Report& state : states) state.time = now;
    const auto readings = farm.tick(std::exchange(now, now + 250 * kMs), states);
    EXPECT_EQ(readings.size(), 1u);
    return {readings[0].values.begin(), readings[0].values.end()};
  }
  /// Returns the reading with robots in these states, without any before.
  static std::vector<double> alone(const base::Report& first, const base::Report& second) {
    Scene scene;
    scene.states = {first, second};
    return scene.tick();
  }
};

/// Tilting on the spot moves beams and bodies, and so ends the reuse of readings at rest.
TEST(Tilt, EndsTheReuseOfReadings) {
  Scene scene;
  const std::vector<double> level = scene.tick();
  for (int k = 0; k < 3; ++k) scene.tick();
  ASSERT_GT(scene.farm.stats().reused, 0u);
  const std::uint64_t reused = scene.farm.stats().reused;
  for (const std::uint32_t mover : {0u, 1u}) {
    scene.states[mover].tilt.roll = 0.4;
    const std::vector<double> tilted = scene.tick();
    EXPECT_NE(tilted, level) << mover;
    EXPECT_EQ(tilted, Scene::alone(scene.states[0], scene.states[1])) << mover;
  }
  EXPECT_EQ(scene.farm.stats().reused, reused);
}

/// Sensors that are due between two ticks are on the screw motion.
TEST(Tilt, IsInterpolatedBetweenTicks) {
  Scene scene;
  scene.tick();
  const std::vector<base::Report> before = scene.states;
  scene.states[0].time = scene.states[1].time = kSecond;
  scene.states[0].X_WM.x += 0.5, scene.states[0].X_WM.z += 0.25, scene.states[0].tilt = {0.1, -0.3};
  const std::int64_t due = scene.farm.next_due();
  const auto readings = scene.farm.sample_between(due, scene.states);
  ASSERT_EQ(readings.size(), 1u);
  const base::Report between = robots::interpolate(before[0], scene.states[0], due);
  EXPECT_EQ(readings[0].tilt.pitch, between.tilt.pitch);
  EXPECT_LT(between.tilt.pitch, 0.0);
  EXPECT_EQ(std::vector<double>(readings[0].values.begin(), readings[0].values.end()),
            Scene::alone(between, before[1]));
}

}  // namespace
}  // namespace sf::farm
