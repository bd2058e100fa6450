// Light sensors: inverse square, incidence, beams of lamps, shadows, and the value of a Khepera.

#include "sensors/lightsensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/illumination.h"
#include "tests/sensors/host_trial.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::illuminance_of;
using world::Lamp;

Lamp lamp(const Pose& X_WL, double intensity = 100.0, double fov = 2.0 * M_PI) {
  return {world::kNone, X_WL, intensity, fov};
}

/// A sensor of one element at the origin, 0.1 m above the ground, that looks along +x.
world::World one_light_element(std::vector<Lamp> lamps, const Pose& X_WM = {}) {
  world::World world = carriers(fitted("lightsensor"), {X_WM});
  world.movers[0].sensors[0].X_MS.z = 0.1;
  world.lamps = std::move(lamps);
  return world;
}

double light_in(const world::World& world) { return read_once(world)[0]; }

// --- Lamps.

TEST(LightSensor, LightFallsWithTheSquareOfTheDistance) {
  for (const double distance : {0.01, 0.5, 1.0, 2.0, 10.0, 300.0})
    EXPECT_DOUBLE_EQ(illuminance_of(lamp({distance, 0, 0, 0}), {}, {1, 0}), 100.0 / (distance * distance));
  EXPECT_DOUBLE_EQ(illuminance_of(lamp({0.001, 0, 0, 0}), {}, {1, 0}), 1e6) << "nearer than 1 cm as at 1 cm";
  EXPECT_DOUBLE_EQ(illuminance_of(lamp({}), {}, {1, 0}), 1e6) << "in the lamp";
  EXPECT_GT(illuminance_of(lamp({316.2, 0, 0, 0}), {}, {1, 0}), 0.0) << "just above 0.001 lx";
  EXPECT_EQ(illuminance_of(lamp({316.3, 0, 0, 0}), {}, {1, 0}), 0.0) << "just below";
}

TEST(LightSensor, LightFallsWithTheCosineOfIncidence) {
  for (const double degrees : {0.0, 30.0, -60.0, 89.0})
    EXPECT_NEAR(illuminance_of(lamp({2, 0, 0, 0}), {}, base::rotate(degrees * kDegree, {1, 0})),
                25.0 * std::cos(degrees * kDegree), 1e-12);
  for (const double degrees : {90.001, 180.0, -120.0})
    EXPECT_EQ(illuminance_of(lamp({2, 0, 0, 0}), {}, base::rotate(degrees * kDegree, {1, 0})), 0.0) << "behind it";
  EXPECT_NEAR(illuminance_of(lamp({3, 0, 4, 0}), {}, {1, 0}), 100.0 / 25.0 * 3.0 / 5.0, 1e-12) << "from above";
  EXPECT_NEAR(illuminance_of(lamp({0, 0, 2, 0}), {}, {1, 0}), 0.0, 1e-12) << "straight above a vertical surface";
}

TEST(LightSensor, LampsHaveBeams) {
  const auto at = [](double degrees, double fov) {
    const glm::dvec2 p = base::rotate((30.0 + degrees) * kDegree, {2.0, 0.0});
    return illuminance_of(lamp({0, 0, 0, 30 * kDegree}, 100.0, fov * kDegree), {p.x, p.y, 0}, -0.5 * p);
  };
  EXPECT_NEAR(at(19.9, 40), 25.0, 1e-9);
  EXPECT_NEAR(at(-19.9, 40), 25.0, 1e-9);
  EXPECT_EQ(at(20.1, 40), 0.0);
  EXPECT_EQ(at(180, 359), 0.0);
  EXPECT_NEAR(at(180, 360), 25.0, 1e-9) << "all round";
}

// --- Readings.

TEST(LightSensor, AddsLampsAndAmbientLight) {
  EXPECT_EQ(light_in(one_light_element({})), 0.0) << "darkness";
  world::World world = one_light_element({lamp({2, 0, 0.1, 0}), lamp({0, 1, 0.1, 0}), lamp({-1, 0, 0.1, 0})});
  EXPECT_DOUBLE_EQ(light_in(world), 25.0) << "one ahead, one at the side, one behind";
  world.ambient_light = 40.0;
  EXPECT_DOUBLE_EQ(light_in(world), 65.0);
  EXPECT_NEAR(light_in(one_light_element({lamp({2, 0, 0.1, 0})}, {0, 0, 0, M_PI / 3})), 12.5, 1e-12)
      << "turned by 60 degrees";
}

TEST(LightSensor, ElementsHaveTheirOwnPlacesAndDirections) {
  world::World world =
      carriers(fitted("lightsensor", {setting("scount", {3}), setting("spose[0]", {0, 0, 0}),
                                      setting("spose[1]", {1, 0, 0}), setting("spose3[2]", {0, 0, 1, 90})}));
  world.lamps = {lamp({2, 0, 0, 0}), lamp({0, 2, 1, 0}, 4.0)};
  const std::vector<double> r = read_once(world);
  ASSERT_EQ(r.size(), 6u);
  EXPECT_NEAR(r[0], 25.0, 1e-12);
  EXPECT_NEAR(r[2], 100.0, 1e-12) << "a metre nearer";
  EXPECT_NEAR(r[4], 1.0, 1e-12) << "to the left, a metre up";
}

/// A wall blocks where the line to the lamp crosses it within its heights.
TEST(LightSensor, WallsCastShadows) {
  world::World world = one_light_element({lamp({2, 0, 0.1, 0})});
  const auto wall = [&](double x, double z_min, double z_max, std::uint32_t model = 7) {
    world.walls = {{.a = {x, -1}, .b = {x, 1}, .z_min = z_min, .z_max = z_max, .model = model}};
    return light_in(world) > 0.0;
  };
  EXPECT_FALSE(wall(1, 0, 1));
  EXPECT_TRUE(wall(1, 0, 0.1)) << "just too low";
  EXPECT_FALSE(wall(1, 0.1, 1)) << "just low enough";
  EXPECT_TRUE(wall(1, 0.11, 1)) << "it hangs above";
  EXPECT_TRUE(wall(3, 0, 1)) << "behind the lamp";
  EXPECT_TRUE(wall(-1, 0, 1)) << "behind the sensor";
  world.lamps[0].model = 3;
  EXPECT_TRUE(wall(1, 0, 1, 3)) << "the lamp's own body";
  EXPECT_FALSE(wall(1, 0, 1, 4));
  world.walls[0].seen_by_laser = false;
  EXPECT_GT(light_in(world), 0.0) << "glass";
  world.lamps = {lamp({2, 0, 2.1, 0})};
  EXPECT_TRUE(wall(1, 0, 1)) << "the line is 1.1 m high there";
  EXPECT_FALSE(wall(1, 0, 1.2));
  EXPECT_FALSE(wall(0.25, 0, 0.5)) << "0.35 m high near the sensor";
}

TEST(LightSensor, ValueFallsFromDarkToBright) {
  const auto value = [](double light, std::vector<world::Setting> settings = {}) {
    world::World world = carriers(fitted("lightsensor", std::move(settings)));
    world.ambient_light = light;
    return read_once(world)[1];
  };
  EXPECT_EQ(value(0), 450.0);
  EXPECT_EQ(value(500), 225.0);
  EXPECT_EQ(value(1000), 0.0);
  EXPECT_EQ(value(1e6), 0.0) << "saturates";
  EXPECT_EQ(value(50, {setting("dark", {1000}), setting("bright", {100})}), 500.0);
}

/// Compares the tree with the sum over all lamps.
TEST(LightSensor, TreeMatchesTheSumOverAllLamps) {
  Chance chance(3);
  world::World world = carriers(fitted("lightsensor"), {});
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = chance.in_square(15), q = chance.in_square(15);
    world.lamps.push_back(lamp({p.x, p.y, 1.0, chance.between(-4, 4)}, chance.between(0.001, 0.2), 2.0));
    scenes::add_carrier(world, {q.x, q.y, 0, chance.between(-4, 4)}, fitted("lightsensor"));
  }
  const Glance run(world);
  std::size_t lit = 0;
  for (const auto& r : run.readings) {
    double sum = 0.0;
    for (const Lamp& l : world.lamps)
      sum += illuminance_of(l, {r.X_WS.x, r.X_WS.y, r.X_WS.z}, base::rotate(r.X_WS.yaw, {1, 0}));
    EXPECT_NEAR(r.values[0], sum, 1e-12);
    lit += sum > 0.0;
  }
  EXPECT_GT(lit, 50u);
}

TEST(LightSensor, RejectsInvalidSettings) {
  expect_refused("lightsensor", {setting("dark", {1024})}, 8, "'dark' is 1024; expected 0 to 1023");
  expect_refused("lightsensor", {setting("bright", {0})}, 8, "'bright' is 0");
  expect_refused("lightsensor", {setting("scount", {65})}, 8, "expected 1 to 64");
}

}  // namespace
}  // namespace sf::trial
