// Every range is compared with the brute-force reference: real and artificial floor plans, near the origin and far from
// it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/random.h"
#include "sensors/laser_settings.h"
#include "tests/instrumented.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

const std::uint32_t kLaserRobots = instrumented() ? 6 : 24;  ///< each beam is checked against every segment
constexpr double kRanges[] = {0.75, 8.0, 30.0, 100.0};

/// Robots with bodies at random free poses, with two of four ranges each time, to mix list configurations.
world::World with_random_robots(world::World world, double range, std::uint64_t seed) {
  scenes::add_robots(world, kLaserRobots, scenes::laser(181, M_PI, range), seed);
  return world;
}

/// At 10 000 km, coordinates are multiples of 2 nm: the translated world differs, but its ranges are as exact.
TEST(Exact, ClosedCaveAtAnyDistanceFromTheOrigin) {
  for (const double far : {0.0, 1e5, 1e7})
    for (const double range : kRanges) {
      if (instrumented() && (far == 0.0 || range > 8.0)) continue;
      world::World world = with_random_robots(scenes::cave(500, 16.0, 3), range, 1);
      world::translate(world, far, -far);
      const Tally tally = sweep(world);
      expect_exact(fmt::format("cave at {} m, range {} m", far, range), tally);
      EXPECT_GT(tally.met, tally.beams / 10);
    }
}

TEST(Exact, OverlappingBoxesAtAnyAngle) {
  for (const double range : kRanges)
    expect_exact("boxes, " + std::to_string(range) + " m",
                 sweep(with_random_robots(scenes::boxes(60, 20.0, 5), range, 3)));
  world::World world = with_random_robots(scenes::boxes(300, 150.0, 6), 100.0, 4);
  expect_exact("wide boxes, 100 m", sweep(world));
  world::translate(world, -1e5, 1e5);
  expect_exact("wide boxes at 100 km, 100 m", sweep(world));
}

/// World files: robots with the file's first laser at random free poses.
void file_test(const std::string& file) {
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  world::World world = world::load_world(file, {.sensors = sensors::world_file_words()});
  const bool robots = !world.movers.empty() && !sensors::lasers_of(world.movers[0]).empty() && !world.movers[0].is_tag;
  if (robots) {
    world::clone_robots(world, kLaserRobots, 7);
    for (world::Mover& mover : world.movers)
      scenes::edit_lasers(mover, [](auto& laser) {
        laser.noise = {};
        laser.range_min = 0.0;
        laser.resolution = 1;
      });
  } else {
    world.movers.clear();
    scenes::add_robots(world, kLaserRobots, scenes::laser(181, 2.0 * M_PI, 30.0), 7);
  }
  const Tally tally = sweep(world);
  expect_exact(std::filesystem::path(file).filename().string(), tally);
  world::translate(world, 1e5, 1e5);
  expect_exact(std::filesystem::path(file).filename().string() + " at 100 km", sweep(world));
}

TEST(Exact, CaveWorld) { file_test(SF_SOURCE_DIR "/worlds/cave.world"); }
TEST(Exact, RoomsWorld) { file_test(SF_SOURCE_DIR "/worlds/rooms.world"); }
TEST(Exact, StageSimpleWorld) { file_test(SF_SOURCE_DIR "/../shared/data/stage/simple.world"); }
TEST(Exact, RosMap) { file_test(SF_SOURCE_DIR "/../shared/data/maps/warehouse.yaml"); }

}  // namespace
}  // namespace sf::trial
