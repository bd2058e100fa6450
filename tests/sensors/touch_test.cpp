// Sensors on walls, at corners and in solids.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

constexpr double kFar = 8.0;

world::World unit_box() {
  world::World world;
  scenes::add_outline(world, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "box");
  return world;
}

/// Returns the range of one beam from (0.5, 1 + above) at `heading`: the top of the unit box is at y = 1.
double look(double above, double heading) {
  world::World world = unit_box();
  add_eye(world, {0.5, 1.0 + above, 0.0, heading}, eye(1, 0.0, kFar));
  return Glance(world).readings[0].values[0];
}

constexpr double kUp = 0.5 * M_PI;
constexpr double kDown = -0.5 * M_PI;

TEST(Touch, SensorOnASurfaceReadsZeroIntoItAndSeesFreelyOffIt) {
  // On the surface, and half a nanometre on either side: less than the contact distance of 1 nm.
  for (const double above : {0.0, 0.5e-9, -0.5e-9}) {
    EXPECT_EQ(look(above, kUp), kFar) << above;
    EXPECT_LE(look(above, kDown), 1e-9) << above;
    EXPECT_LE(look(above, kDown + 1.0), 2e-9) << above;
    EXPECT_EQ(look(above, kUp - 1.0), kFar) << above;
  }
  EXPECT_EQ(look(0.0, kDown), 0.0);
}

/// The contact distance is measured along the beam: at an angle, half a nanometre of depth may exceed it.
TEST(Touch, ObliqueBeamHasALongerContactDistance) {
  EXPECT_NEAR(look(-0.5e-9, kUp - 1.5), 0.5e-9 / std::sin(M_PI / 2 - 1.5), 1e-14);
  EXPECT_NEAR(look(0.5e-9, kDown + 1.5), 0.5e-9 / std::sin(M_PI / 2 - 1.5), 1e-14);
}

TEST(Touch, SensorBeyondTheContactDistanceIsOnOneSide) {
  // Outside: the gap, and no hit.
  EXPECT_NEAR(look(2e-9, kDown), 2e-9, 1e-15);
  EXPECT_EQ(look(2e-9, kUp), kFar);
  // Inside: the distance out, in both directions.
  EXPECT_NEAR(look(-2e-9, kUp), 2e-9, 1e-15);
  EXPECT_NEAR(look(-2e-9, kDown), 1.0 - 2e-9, 1e-12);
}

/// A thin wall has no inside. It stops beams from either side, and contact acts as for a solid on the left of a -> b.
TEST(Touch, ThinWallIsVisibleFromBothSides) {
  world::World world;
  scenes::add_outline(world, {{-1, 0}, {1, 0}}, "wall");
  world.walls.pop_back();
  world.walls[0].solid_left = false;
  add_eye(world, {0, 1, 0, kDown}, eye(1, 0.0, kFar));
  add_eye(world, {0, -1, 0, kUp}, eye(1, 0.0, kFar));
  add_eye(world, {0, 0, 0, kUp}, eye(1, 0.0, kFar));
  add_eye(world, {0, 0, 0, kDown}, eye(1, 0.0, kFar));
  const Glance run(world);
  EXPECT_NEAR(run.readings[0].values[0], 1.0, 1e-12);
  EXPECT_NEAR(run.readings[1].values[0], 1.0, 1e-12);
  EXPECT_EQ(run.readings[2].values[0], 0.0);
  EXPECT_EQ(run.readings[3].values[0], kFar);
}

/// On walls and within nanometres of them, on corners, at odd angles: the contact rule holds for every beam.
TEST(Touch, EverywhereOnTheWallsOfBoxesAndACave) {
  for (const bool bitmap : {false, true}) {
    world::World world = bitmap ? scenes::cave(60, 8.0, 2) : scenes::boxes(20, 10.0, 8);
    Chance chance(3);
    for (int i = 0; i < 150; ++i) {
      const world::Segment s = world.walls[chance.below(static_cast<std::uint32_t>(world.walls.size()))];
      const glm::dvec2 e = s.b - s.a;
      const double along = i % 4 == 0 ? 0.0 : i % 4 == 1 ? 0.5 : chance.between(0.0, 1.0);
      constexpr double kAside[] = {0.0, 0.5e-9, -0.5e-9, 3e-9, -3e-9, 1e-6, -1e-6};
      const glm::dvec2 p = s.a + along * e + (kAside[i % 7] / length(e)) * glm::dvec2{e.y, -e.x};
      add_eye(world, {p.x, p.y, 0.0, chance.between(-M_PI, M_PI)}, eye(37, 2.0 * M_PI, kFar));
    }
    expect_exact(bitmap ? "on the walls of a cave" : "on the walls of boxes", sweep(world));
  }
}

/// Boxes overlap: from inside several of them, the first surface in any direction counts.
TEST(Touch, InsideOverlappingSolids) {
  world::World world = scenes::boxes(120, 10.0, 9);
  Chance chance(5);
  for (int i = 0; i < 150; ++i) {
    const glm::dvec2 p = chance.in_square(4.5);
    add_eye(world, {p.x, p.y, 0.0, chance.between(-M_PI, M_PI)}, eye(61, 2.0 * M_PI, kFar));
  }
  expect_exact("inside overlapping solids", sweep(world));
}

}  // namespace
}  // namespace sf::trial
