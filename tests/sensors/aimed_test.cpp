// Beams in degenerate positions: at vertices, along walls, through corners where bitmap cells meet.

#include <gtest/gtest.h>

#include "sensors/laser_settings.h"
#include "tests/instrumented.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const int kEyes = instrumented() ? 100 : 400;

/// Eyes at random points, including points inside solids, whose middle beam hits a vertex: nine beams around it, or
/// four within a nanometre.
void aim_at_vertices(world::World& world, double half, double range, std::uint64_t seed) {
  Chance chance(seed);
  for (int i = 0; i < kEyes; ++i) {
    const world::Segment& s = world.walls[chance.below(static_cast<std::uint32_t>(world.walls.size()))];
    const sensors::LaserSettings laser = i % 2 ? eye(9, 1e-6, range) : eye(5, 4e-10, range);
    glm::dvec2 from = chance.in_square(half);
    if (i % 3) from = s.a + (0.1 * range / half) * from;  // mostly close by, so that the beam reaches the vertex
    aim(world, from, chance.below(2) ? s.a : s.b, laser);
  }
}

TEST(Aimed, AtTheVerticesOfACave) {
  for (const double range : {0.75, 8.0}) {
    if (instrumented() && range > 1.0) continue;
    world::World world = scenes::cave(500, 16.0, 3);
    aim_at_vertices(world, 8.0, range, 1);
    const Tally tally = sweep(world);
    expect_exact("aimed at vertices of the cave, " + std::to_string(range) + " m", tally);
    EXPECT_GT(tally.ambiguous, tally.beams / 100) << "the test does not aim well";
    EXPECT_LT(tally.silhouettes, tally.ambiguous);
    world::translate(world, 1e5, 1e5);
    expect_exact("the same at 100 km", sweep(world));
  }
}

TEST(Aimed, AtTheVerticesOfBoxes) {
  world::World world = scenes::boxes(60, 20.0, 5);
  aim_at_vertices(world, 10.0, 30.0, 2);
  expect_exact("aimed at vertices of boxes", sweep(world));
}

/// Unit squares on the black fields of a checkerboard: free fields touch only at corners.
world::World checkerboard(int n) {
  world::World world;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const glm::dvec2 p{1.0 * x, 1.0 * y};
      if ((x + y) % 2 == 0)
        scenes::add_outline(world, {p, p + glm::dvec2{1, 0}, p + glm::dvec2{1, 1}, p + glm::dvec2{0, 1}},
                            "field" + std::to_string(x));
    }
  return world;
}

/// From a free field, every beam ends at the field's border, even when aimed exactly at a corner.
TEST(Aimed, NoBeamPassesDiagonalCorners) {
  world::World world = checkerboard(8);
  Chance chance(4);
  for (int i = 0; i < kEyes; ++i) {
    const glm::dvec2 field{3.0, 4.0};
    // On lattices of eighths and thirds, and at random.
    const double grid = i % 3 == 0 ? 8.0 : 3.0;
    glm::dvec2 p{(1.0 + chance.below(static_cast<std::uint32_t>(grid) - 1)) / grid,
                 (1.0 + chance.below(static_cast<std::uint32_t>(grid) - 1)) / grid};
    if (i % 3 == 2) p = {chance.between(0.001, 0.999), chance.between(0.001, 0.999)};
    const glm::dvec2 corner{static_cast<double>(chance.below(2)), static_cast<double>(chance.below(2))};
    aim(world, field + p, field + corner, eye(i % 2 ? 1 : 5, i % 2 ? 0.0 : 1e-15, 20.0));
  }
  for (const double far : {0.0, 1048576.0}) {
    world::translate(world, far, far);
    const Glance run(world);
    std::size_t beams = 0;
    for (const auto& reading : run.readings)
      for (const double range : reading.values) {
        ++beams;
        ASSERT_LE(range, std::sqrt(2.0)) << "mover " << reading.mover;
      }
    EXPECT_GT(beams, static_cast<std::size_t>(kEyes));
    expect_exact("corners of a checkerboard", sweep(world));
  }
}

/// From lattice points along the lattice: through corners, along walls, from corners.
TEST(Aimed, AlongTheLattice) {
  world::World world = checkerboard(6);
  for (int y = -2; y <= 14; ++y)
    for (int x = -2; x <= 14; ++x)
      for (int k = 0; k < 4; ++k)
        add_eye(world, {0.5 * x, 0.5 * y, 0.0, 0.5 * M_PI * k}, eye(k % 2 ? 9 : 5, 2.0 * M_PI, 20.0));
  expect_exact("along the lattice", sweep(world));
}

/// A long wall seen at `grazing` [rad], axis-aligned and rotated, thin and thick.
world::World long_wall(double yaw, double grazing, bool thick) {
  world::World world;
  const auto at = [yaw](double x, double y) { return base::rotate(yaw, {x, y}); };
  if (thick) {
    scenes::add_outline(world, {at(-1, -0.5), at(100, -0.5), at(100, 0), at(-1, 0)}, "wall");
  } else {
    scenes::add_outline(world, {at(-1, 0), at(100, 0)}, "wall");
    for (world::Segment& s : world.walls) s.solid_left = false;
  }
  for (const double distance : {1.0, 17.0, 50.0, 95.0})
    for (int i = 0; i < 8; ++i) {
      const double x = 0.123 * i;
      aim(world, at(x, distance * std::tan(grazing)), at(x + distance, 0.0), eye(5, 0.5 * grazing, 100.0));
    }
  return world;
}

TEST(Aimed, GrazingALongWall) {
  for (const double grazing : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7})
    for (const double yaw : {0.0, 0.7, -2.5}) {
      Tally tally;
      for (const bool thick : {false, true})
        for (const double far : {0.0, 1e5}) {
          world::World world = long_wall(yaw, grazing, thick);
          world::translate(world, far, -far);
          tally += sweep(world);
        }
      expect_exact("grazing at " + std::to_string(1e6 * grazing) + " urad", tally);
      EXPECT_LE(tally.worst_grazing, 1e-5 * std::max(1.0, 1e-6 / grazing));
      EXPECT_GT(tally.met, tally.beams / 2);
    }
}

/// A sensor collinear with a wall: in front of it, within it and behind it.
TEST(Aimed, CollinearWithAWall) {
  for (const double yaw : {0.0, 0.5 * M_PI, 0.3}) {
    world::World world;
    const auto at = [yaw](double x, double y) { return base::rotate(yaw, {x, y}); };
    scenes::add_outline(world, {at(1, 0), at(2, 0), at(2, 1), at(1, 1)}, "box");
    scenes::add_room(world, {1, 0}, 14.0);
    for (const double x : {-2.0, 0.0, 1.0, 1.5, 2.0, 3.0})
      for (const double turn : {0.0, M_PI}) {
        const glm::dvec2 p = at(x, 0.0);
        add_eye(world, {p.x, p.y, 0.0, yaw + turn}, eye(9, 1e-3, 20.0));
        add_eye(world, {p.x, p.y, 0.0, yaw + turn}, eye(37, 2.0 * M_PI, 20.0));
      }
    expect_exact("collinear with a wall", sweep(world));
  }
}

}  // namespace
}  // namespace sf::trial
