// Complete loaded worlds, compared with golden records.

#include <gtest/gtest.h>

#include "tests/golden.h"
#include "tests/world/dump_world.h"
#include "tests/world/read_world.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

const std::string kFolder = SF_SOURCE_DIR "/tests/world/golden/";

void expect_recorded(const std::string& name, const std::string& dump) { golden::expect(dump, "world", name, 1e-6); }

World golden_world(const std::string& name, LoadOptions options = kWithLasers) {
  static constexpr std::string_view kEdgeKeys[] = {"samples", "fov"};
  static constexpr SensorKeyword kWords[] = {kLaserWords[0], kLaserWords[1], {"laneedge", kEdgeKeys}};
  options.sensors = kWords;
  return load_world(kFolder + name, options);
}

TEST(LoadRecords, BodiesOfEveryKind) { expect_recorded("bodies", dump_of(golden_world("bodies.world"))); }

TEST(LoadRecords, RobotsAndTheirSensors) { expect_recorded("robots", dump_of(golden_world("robots.world"))); }

TEST(LoadRecords, StageRulesForNoiseAndObstacles) {
  LoadOptions options;
  options.stage_noise = options.stage_obstacles = true;
  options.accuracy = "near";
  const std::string robots = dump_of(golden_world("robots.world", options));
  expect_in("(\"noise\" [20 0.5] ", robots);
  EXPECT_EQ(robots.find("(\"accuracy\" "), std::string::npos) << "the option replaces each sensor's own";
  const World bodies = golden_world("bodies.world", options);
  for (const Segment& wall : bodies.walls) EXPECT_FALSE(bodies.models[wall.model].is_bitmap && wall.stops_robots);
  EXPECT_EQ(bodies.accuracy.word, "near");
  EXPECT_EQ(bodies.accuracy.line, 0);
}

TEST(LoadRecords, StreetsWithPaintMagnetsAndLights) {
  expect_recorded("street", dump_of(golden_world("street.world")));
}

TEST(LoadRecords, RoadNetworkWithAllItsTransitions) {
  std::vector<Warning> warnings;
  expect_recorded("small", dump_of(load_roads(kFolder + "small.rndf", warnings)));
  EXPECT_EQ(warnings_of(World{.warnings = warnings}), "");
}

TEST(LoadRecords, PlanOfLights) {
  World world;
  for (const char* name : {"a", "b", "c", "d"})
    world.lights.push_back({.name = name, .phases = {{LightState::green, 1.0}}});
  const LightPlan plan = parse_light_plan(kFolder + "lights.toml", golden::read(kFolder + "lights.toml"), world);
  expect_recorded("lights", dump_of(plan) + dump_of(world));
}

TEST(LoadRecords, SnapshotContainsTheWholeWorld) {
  for (const char* name : {"bodies.world", "robots.world", "street.world"}) {
    World world = golden_world(name);
    for (Mover& m : world.movers) m.X_MT = {}, m.controller.clear();
    const World again = from_snapshot(snapshot(world));
    EXPECT_EQ(dump_of(again), dump_of(world)) << name;
    EXPECT_EQ(again.hash, world.hash) << name;
    EXPECT_EQ(snapshot(again), snapshot(world)) << name;
  }
}

}  // namespace
}  // namespace sf::world
