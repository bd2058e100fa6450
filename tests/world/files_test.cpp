// The worlds and maps of Stage and ROS, if present, and those of this project.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/world/read_world.h"

namespace sf::world {
namespace {

const std::string kShared = SF_SOURCE_DIR "/../shared/data";

#define NEED_SHARED() \
  if (!std::filesystem::exists(kShared)) GTEST_SKIP() << "no shared data next to the sources"

std::size_t count_lasers(const World& world) {
  std::size_t count = 0;
  for (const Mover& mover : world.movers) count += mover.sensors.size();
  return count;
}

/// Each laser must be at a height with walls, otherwise the world is useless.
void expect_lasers_see_walls(const World& world) {
  for (const Mover& mover : world.movers) {
    for (const Sensor& laser : mover.sensors) {
      const double z = mover.X_WM.z + laser.X_MS.z + 0.5 * laser.height;
      const auto spans = [&](const Segment& wall) { return wall.seen_by_laser && wall.z_min <= z && z < wall.z_max; };
      EXPECT_TRUE(std::any_of(world.walls.begin(), world.walls.end(), spans))
          << mover.name << " " << laser.name << " " << z;
    }
  }
}

/// Expects closed outlines: equal numbers of segments start and end at each point.
void expect_closed(const World& world) {
  std::map<std::pair<double, double>, int> balance;
  for (const Segment& wall : world.walls) {
    if (!world.models[wall.model].is_bitmap) continue;
    ++balance[{wall.a.x, wall.a.y}];
    --balance[{wall.b.x, wall.b.y}];
  }
  for (const auto& [point, sum] : balance) ASSERT_EQ(sum, 0) << point.first << ", " << point.second;
}

TEST(WorldFiles, Cave) {
  const World world = load_world(SF_SOURCE_DIR "/worlds/cave.world", kWithLasers);
  EXPECT_TRUE(world.warnings.empty()) << warnings_of(world);
  ASSERT_EQ(world.movers.size(), 1u);
  const Mover& robot = world.movers[0];
  EXPECT_EQ(robot.name, "roomba1");
  EXPECT_EQ(robot.id, 1u);
  EXPECT_NEAR(robot.radius, 0.165, 1e-5);
  ASSERT_EQ(robot.sensors.size(), 1u);
  EXPECT_EQ(robot.sensors[0].settings[0].numbers, std::vector<double>{361});
  EXPECT_GT(world.walls.size(), 500u);
  EXPECT_LT(world.walls.size(), 1500u);
  EXPECT_EQ(world.extent.x_min, -8.0);
  EXPECT_EQ(world.extent.x_max, 8.0);
  expect_lasers_see_walls(world);
  expect_closed(world);
}

TEST(WorldFiles, Rooms) {
  const World world = load_world(SF_SOURCE_DIR "/worlds/rooms.world", kWithLasers);
  EXPECT_TRUE(world.warnings.empty()) << warnings_of(world);
  EXPECT_EQ(world.movers.size(), 3u);
  EXPECT_EQ(count_lasers(world), 4u);
  expect_lasers_see_walls(world);
}

TEST(WorldFiles, SimpleHasTwoPioneersWithSonarAndLaser) {
  NEED_SHARED();
  const World world = load_world(kShared + "/stage/simple.world", kWithLasers);
  EXPECT_EQ(world.warnings.size(), 1u) << warnings_of(world);  // the floor plan stops robots
  EXPECT_EQ(world.movers.size(), 2u);
  EXPECT_EQ(count_lasers(world), 2u * 17u);
  EXPECT_EQ(world.movers[0].name, "r0");
  EXPECT_EQ(world.movers[0].controller, "wander");
  EXPECT_EQ(world.movers[0].max_forward, 0.5);
  EXPECT_NEAR(world.movers[0].sensors.back().X_MS.z, 0.22 + 0.1 + 0.01, 1e-12);
  EXPECT_TRUE(world.walls[0].stops_robots);
  expect_lasers_see_walls(world);
  expect_closed(world);
}

TEST(WorldFiles, RoombaKeepsItsBumper) {
  NEED_SHARED();
  const World world = load_world(kShared + "/stage/roomba.world", kWithLasers);
  EXPECT_EQ(world.movers.size(), 1u);
  EXPECT_EQ(world.unmodelled, (std::map<std::string, int>{{"bumper", 1}}));
  // The floor plan stops robots, and the size of the bumper has four numbers.
  EXPECT_EQ(world.warnings.size(), 3u) << warnings_of(world);
  EXPECT_EQ(world.movers[0].body.size(), 16u);
  EXPECT_NEAR(world.movers[0].radius, 0.165, 1e-3);
}

TEST(WorldFiles, CaveHasAHundredRobots) {
  NEED_SHARED();
  const World world = load_world(kShared + "/stage/benchmark/cave.world", kWithLasers);
  EXPECT_EQ(world.movers.size(), 100u);
  EXPECT_EQ(count_lasers(world), 100u * 17u);
  EXPECT_EQ(world.models.size(), 1u + 100u * 3u);
  // One robot defined twice, a floor plan that stops robots, and Stage's plug-in as the controller of all robots.
  EXPECT_EQ(world.warnings.size(), 3u) << warnings_of(world);
  expect_lasers_see_walls(world);
}

TEST(WorldFiles, HospitalHasAThousandRobotsWithTwelveSensors) {
  NEED_SHARED();
  const World world = load_world(kShared + "/stage/benchmark/hospital.world", kWithLasers);
  // The plan's margins, the plan that stops robots, and Stage's plug-in as the controller.
  EXPECT_EQ(world.warnings.size(), 3u) << warnings_of(world);
  EXPECT_EQ(world.movers.size(), 1000u);
  EXPECT_EQ(count_lasers(world), 12'000u);
  EXPECT_EQ(world.extent.x_max, 70.0);
  EXPECT_EQ(world.extent.y_min, -29.5);
  expect_lasers_see_walls(world);
  expect_closed(world);
}

/// Plausible numbers must not cause warnings about units.
TEST(WorldFiles, StageWorldsAndRosMapsHaveNoUnitWarnings) {
  NEED_SHARED();
  static constexpr std::string_view kKeys[] = {"fov", "range", "sview", "view", "range_max", "scount", "spose[]"};
  static constexpr SensorKeyword kWords[] = {
      {"laser", kKeys}, {"ranger", kKeys, kKeys}, {"sonar", kKeys}, {"infrared", kKeys}};
  std::size_t loaded = 0;
  for (const char* folder : {"/stage", "/maps"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kShared + folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".world" && ending != ".inc" && ending != ".yaml") continue;
      World world;
      try {
        world = load_world(entry.path().string(), LoadOptions{.sensors = kWords});
      } catch (const base::InputError&) {
        continue;  // its picture is missing here, or it is not a complete world
      }
      EXPECT_EQ(warnings_of(world).find("looks like"), std::string::npos) << entry.path() << warnings_of(world);
      ++loaded;
    }
  EXPECT_GE(loaded, 8u);
}

TEST(WorldFiles, EveryStageIncludeAndItsDefinitionsLoad) {
  NEED_SHARED();
  std::string all;
  for (const char* name :
       {"beacons", "chatterbox", "hokuyo", "irobot", "map", "objects", "pantilt", "pioneer", "sick", "ubot", "walle"}) {
    EXPECT_NO_THROW(load_world(kShared + "/stage/" + name + ".inc", kWithLasers)) << name;
    all += "include \"" + kShared + "/stage/" + name + ".inc\"\n";
  }
  const World world =
      read_world(all +
                 "laserchatterbox( fancysicklaser() pantiltcamera() ) pioneer3dx() pioneer3at() amigobot() walle()\n"
                 "ubot() fancypantiltcamer() laserbeacon() visionbeacon_cyan() red_puck() charger() zone()\n"
                 "position( p3dx_sonar() fancypioneer2dx() pioneer2dx_front_sonar() )");
  EXPECT_EQ(world.unmodelled.at("reb_position"), 1);
  EXPECT_EQ(world.unmodelled.at("puck"), 1);
  EXPECT_GT(world.walls.size(), 20u);
}

TEST(WorldFiles, BothRosMaps) {
  NEED_SHARED();
  const World skirk = load_world(kShared + "/maps/skirk.yaml");
  EXPECT_TRUE(skirk.warnings.empty()) << warnings_of(skirk);
  EXPECT_EQ(skirk.models.size(), 1u);
  EXPECT_GE(skirk.extent.x_min, -7.801 - 1e-9);
  EXPECT_LE(skirk.extent.x_max, -7.801 + 431 * 0.05 + 1e-9);
  EXPECT_GT(skirk.walls.size(), 100u);
  expect_closed(skirk);

  const World warehouse = load_world(kShared + "/maps/warehouse.yaml");
  EXPECT_GE(warehouse.extent.y_min, -25.0 - 1e-9);
  EXPECT_LE(warehouse.extent.y_max, -25.0 + 1674 * 0.03 + 1e-9);
  EXPECT_GT(warehouse.walls.size(), 1000u);
  expect_closed(warehouse);
}

}  // namespace
}  // namespace sf::world
