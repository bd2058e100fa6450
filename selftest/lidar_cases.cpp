// Spatial scans against every face in `long double`.

#include <fmt/format.h>

#include "scene/reference_scan.h"
#include "scene/solids.h"
#include "selftest/fixture.h"
#include "selftest/suite.h"
#include "sensors/lidar.h"
#include "sensors/sensor_set.h"

namespace sf::selftest {

namespace {

/// Adds a robot with a lidar of 16 rings and 180 columns.
void add_lidar(world::World& world, const Pose& X_WM, double range_max) {
  const std::uint32_t mover = add_mover(world, X_WM);
  world.movers[mover].sensors.push_back(sensor(
      "lidar", {{"channels", {16}}, {"columns", {180}}, {"fov_v", {-23.0, 23.0}}, {"range", {0.0, range_max}}}, 0.5));
}

/// Checks every beam without a flag, and that few have one. @param most part of the beams that may have a flag
void check_lidars(const TestFarm& test, double most, Checks& checks) {
  const scene::SurfaceTree walls = scene::build_tree(scene::mesh_of(test.world->walls));
  const scene::Instance instance{&walls, {}, true};
  const sensors::SensorSet sensor_set(*test.world);
  for (const base::ReadingBlock& reading : test.readings) {
    const sensors::SpatialBeams beams = sensor_set.beams(reading);
    const auto X_WS = base::compose(base::transform_of(reading.X_WM, reading.tilt), beams.X_MS);
    std::size_t flagged = 0;
    for (std::size_t i = 0; i < reading.values.size(); ++i) {
      if (!reading.quality.empty() && reading.quality[i] != base::QualityFlag::none) {
        ++flagged;
        continue;
      }
      const auto hit = scene::reference_scan(X_WS, beams.directions[i], sensor_set.row(reading).limit,
                                             {{&instance, 1}, !test.world->floor_unseen});
      checks.near(reading.values[i], hit.range, reading.bound, "beam", i);
    }
    checks.holds(static_cast<double>(flagged) <= most * static_cast<double>(reading.values.size()),
                 fmt::format("{} of {} beams have a flag", flagged, reading.values.size()));
  }
}

world::World town(glm::dvec2 at) {
  world::World world;
  add_room(world, at - glm::dvec2{20.0, 20.0}, 40.0);
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 5; ++k)
      if (i != 2 || k != 2)
        add_block(world, at + glm::dvec2{6.0 * i - 13.0, 6.0 * k - 13.0},
                  at + glm::dvec2{6.0 * i - 10.5, 6.0 * k - 11.0});
  return world;
}

void far_away(Fixture& fixture, Checks& checks) {
  for (const double far : {0.0, 1e4, 1e7}) {
    world::World world = town({far, -far});
    add_lidar(world, {far + 0.37, -far + 0.21, 0.0, 0.6}, 60.0);
    check_lidars(fixture.measure(std::move(world)), 0.01, checks);
  }
}

void in_planes(Fixture& fixture, Checks& checks) {
  world::World world = town({});
  for (const Pose& X_WM : {Pose{-1.0, 0.0, 0.0, 0.0}, Pose{1.5, 1.0, 0.5, 0.0}, Pose{0.0, -1.0, 0.0, 0.25 * kTurn}})
    add_lidar(world, X_WM, 60.0);
  check_lidars(fixture.measure(std::move(world)), 0.2, checks);
}

void large_and_small(Fixture& fixture, Checks& checks) {
  world::World world;
  add_room(world, {-5e4, -5e4}, 1e5);
  add_block(world, {1.0, -0.5}, {1.001, 0.5});
  add_block(world, {-3.0, 1.0}, {-2.0, 1.000001});
  add_lidar(world, {0.1, 0.2, 0.0, 0.3}, 1e5);
  check_lidars(fixture.measure(std::move(world)), 0.5, checks);
}

constexpr Case kLidarCases[] = {
    {"lidars", "lidar-far-away", "m", "at the origin, 10 km and 10 000 km away: every beam within 10 nm", far_away},
    {"lidars", "lidar-in-planes", "m", "in the planes of walls and tops, looking along axes: within 10 nm or flagged",
     in_planes},
    {"lidars", "lidar-sizes", "m", "walls of 100 km, 1 mm and 1 um in one scene: within 10 nm or flagged",
     large_and_small},
};

}  // namespace

std::span<const Case> lidar_cases() { return kLidarCases; }

}  // namespace sf::selftest
