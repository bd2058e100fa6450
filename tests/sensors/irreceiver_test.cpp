// The Create's infrared receiver: beams, halos, buoys, force fields and obstacles.

#include "sensors/irreceiver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/host_trial.h"
#include "tests/units.h"

namespace sf::trial {
namespace {

using base::Pose;
using sensors::light_of;
using world::Emitter;

Emitter virtual_wall(const Pose& X_WE = {}) {
  return {Emitter::Kind::virtual_wall, world::kNone, X_WE, 2.0, 20 * kDegree, 0.4};
}
/// Buoy beams of 40 degrees: 15 degrees on each side alone, and an overlap of 5 + 5 in the middle.
Emitter dock(const Pose& X_WE = {}) { return {Emitter::Kind::dock, world::kNone, X_WE, 2.0, 40 * kDegree, 0.5}; }

glm::dvec2 at(double distance, double degrees) { return base::rotate(degrees * kDegree, {distance, 0.0}); }

world::World one_receiver(std::vector<Emitter> emitters, const Pose& X_WM = {}) {
  world::World world = carriers(fitted("irreceiver"), {X_WM});
  world.emitters = std::move(emitters);
  return world;
}

// --- Light.

TEST(IrReceiver, VirtualWallHasABeamAndAHalo) {
  EXPECT_EQ(light_of(virtual_wall(), at(1.9, 9.9)), 1u);
  EXPECT_EQ(light_of(virtual_wall(), at(1.9, -9.9)), 1u);
  EXPECT_EQ(light_of(virtual_wall(), at(1.9, 10.1)), 0u) << "outside the beam";
  EXPECT_EQ(light_of(virtual_wall(), at(2.1, 0)), 0u) << "beyond it";
  EXPECT_EQ(light_of(virtual_wall(), at(0.39, 180)), 1u) << "in the halo, behind";
  EXPECT_EQ(light_of(virtual_wall(), at(0.41, 180)), 0u);
  EXPECT_EQ(light_of(virtual_wall(), {0, 0}), 1u) << "on top of it";
}

TEST(IrReceiver, DockHasABuoyOnEachSide) {
  EXPECT_EQ(light_of(dock(), at(1.5, 0)), 8u | 4u) << "both in the middle";
  EXPECT_EQ(light_of(dock(), at(1.5, 4.9)), 8u | 4u);
  EXPECT_EQ(light_of(dock(), at(1.5, 5.1)), 8u) << "red on the dock's left";
  EXPECT_EQ(light_of(dock(), at(1.5, 34.9)), 8u);
  EXPECT_EQ(light_of(dock(), at(1.5, 35.1)), 0u);
  EXPECT_EQ(light_of(dock(), at(1.5, -5.1)), 4u);
  EXPECT_EQ(light_of(dock(), at(1.5, -34.9)), 4u);
  EXPECT_EQ(light_of(dock(), at(2.1, 0)), 0u) << "out of reach";
  EXPECT_EQ(light_of(dock(), at(0.4, 180)), 2u) << "the force field is all round";
  EXPECT_EQ(light_of(dock(), at(0.4, 0)), 8u | 4u | 2u);
}

/// A halo may reach farther than the beam; without a halo nothing is received, even on top of the emitter.
TEST(IrReceiver, HalosOfAnySize) {
  Emitter wide = virtual_wall(), none = dock();
  wide.halo = 3.0;
  none.halo = 0.0;
  EXPECT_EQ(read_once(one_receiver({wide}, {-2.9, 0, 0, 0}))[0], 1.0);
  EXPECT_EQ(read_once(one_receiver({wide}, {-3.1, 0, 0, 0}))[0], 0.0);
  EXPECT_EQ(light_of(none, {0, 0}) & 2u, 0u);
}

/// Light rotates and moves with the emitter, including headings beyond a full turn.
TEST(IrReceiver, LightRotatesWithItsEmitter) {
  Chance chance(1);
  for (int i = 0; i < 500; ++i) {
    const Pose X_WE{chance.between(-9, 9), chance.between(-9, 9), 0, chance.between(-20, 20)};
    const glm::dvec2 p = chance.in_square(2.2);
    EXPECT_EQ(light_of(dock(X_WE), base::transform(X_WE, p)), light_of(dock(), p));
    EXPECT_EQ(light_of(virtual_wall(X_WE), base::transform(X_WE, p)), light_of(virtual_wall(), p));
  }
}

// --- Readings.

TEST(IrReceiver, EncodesBytesOfTheOpenInterface) {
  const auto byte = [](const glm::dvec2& p) { return read_once(one_receiver({dock()}, {p.x, p.y, 0, 1}))[1]; };
  EXPECT_EQ(byte(at(3, 0)), 255.0) << "none";
  EXPECT_EQ(byte(at(1.5, 20)), 248.0) << "red buoy";
  EXPECT_EQ(byte(at(1.5, -20)), 244.0) << "green buoy";
  EXPECT_EQ(byte(at(0.4, 180)), 242.0) << "force field";
  EXPECT_EQ(byte(at(1.5, 0)), 252.0) << "red and green";
  EXPECT_EQ(byte(at(0.4, 20)), 250.0) << "red and field";
  EXPECT_EQ(byte(at(0.4, -20)), 246.0) << "green and field";
  EXPECT_EQ(byte(at(0.4, 0)), 254.0) << "all";
}

TEST(IrReceiver, DistinguishesWallsAndDocks) {
  EXPECT_EQ(read_once(one_receiver({virtual_wall({-1, 0, 0, 0})})), (std::vector<double>{1, 255}));
  EXPECT_EQ(read_once(one_receiver({dock({-1, 0, 0, 0})})), (std::vector<double>{0, 252}));
  EXPECT_EQ(read_once(one_receiver({virtual_wall({-1, 0, 0, 0}), dock({0, 1, 0, -1.2})})),
            (std::vector<double>{1, 244}));
  EXPECT_EQ(read_once(one_receiver({dock({0, 0.4, 0, 1}), dock({0, 1, 0, -M_PI / 2})})), (std::vector<double>{0, 254}))
      << "the union of two docks";
  EXPECT_EQ(read_once(one_receiver({})), (std::vector<double>{0, 255})) << "no emitters";
}

TEST(IrReceiver, WallsAtTheReceiverHeightBlockLight) {
  world::World world = one_receiver({virtual_wall({-1, 0, 0, 0})});
  world.movers[0].sensors[0].X_MS.z = 0.1;
  const auto wall = [&](double z_min, double z_max, std::uint32_t model = 7) {
    world.walls = {{.a = {-0.5, -1}, .b = {-0.5, 1}, .z_min = z_min, .z_max = z_max, .model = model}};
    return read_once(world)[0];
  };
  EXPECT_EQ(wall(0, 1), 0.0);
  EXPECT_EQ(wall(0, 0.1), 1.0) << "just too low";
  EXPECT_EQ(wall(0.1, 1), 0.0) << "just low enough";
  EXPECT_EQ(wall(0.11, 1), 1.0) << "it hangs above";
  world.emitters[0].model = 3;
  EXPECT_EQ(wall(0, 1, 3), 1.0) << "the emitter's own body";
  EXPECT_EQ(wall(0, 1, 4), 0.0);
  world.walls[0].seen_by_laser = false;
  EXPECT_EQ(read_once(world)[0], 1.0) << "glass";
  world.walls[0] = {.a = {0.5, -1}, .b = {0.5, 1}, .z_min = 0, .z_max = 1};
  EXPECT_EQ(read_once(world)[0], 1.0) << "a wall behind the receiver";
}

/// Compares the tree with a test of each of many emitters.
TEST(IrReceiver, TreeMatchesATestOfEveryEmitter) {
  Chance chance(2);
  world::World world = carriers(fitted("irreceiver"), {});
  for (int i = 0; i < 400; ++i) {
    const glm::dvec2 p = chance.in_square(15);
    const glm::dvec2 q = chance.in_square(15);
    world.emitters.push_back(i % 2 == 0 ? dock({p.x, p.y, 0, chance.between(-4, 4)})
                                        : virtual_wall({p.x, p.y, 0, chance.between(-4, 4)}));
    scenes::add_carrier(world, {q.x, q.y, 0, 0}, fitted("irreceiver"));
  }
  const Glance run(world);
  std::size_t lit = 0;
  for (const auto& r : run.readings) {
    std::uint32_t walls = 0, docks = 0;
    for (const Emitter& e : world.emitters)
      (e.kind == Emitter::Kind::dock ? docks : walls) |= light_of(e, {r.X_WM.x, r.X_WM.y});
    EXPECT_EQ(r.values[0], walls);
    EXPECT_EQ(r.values[1], docks == 0 ? 255.0 : 240.0 + docks);
    lit += docks != 0;
  }
  EXPECT_GT(lit, 20u);
  EXPECT_LT(lit, 380u);
}

TEST(IrReceiver, RejectsInvalidSettings) { expect_refused("irreceiver", {setting("rate", {-1})}, 8, "'rate' is -1"); }

}  // namespace
}  // namespace sf::trial
