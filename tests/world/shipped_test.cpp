// The shipped worlds load without a warning and have their documented content.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/world/read_world.h"
#include "world/ground.h"
#include "world/lights.h"
#include "world/roads/roads.h"

namespace sf::world {
namespace {

/// Loads like the programs. Sensors that are not modelled here are kept as written.
World shipped(const std::string& name) {
  static constexpr std::string_view kAny[] = {"fov",     "samples",      "range_max", "range_min",    "scount",
                                              "spose[]", "ssensitivity", "sum",       "perpendicular"};
  static constexpr std::string_view kShippedMap[] = {"cell", "words", "offset", "sources"};
  static constexpr std::string_view kFelt[] = {"zones", "zone[]",     "scount", "spose[]", "per_count",
                                               "track", "slip",       "scrub",  "bias",    "scale_error",
                                               "range", "satellites", "noise",  "scale"};
  static constexpr std::string_view kSeen[] = {"range_max", "range_max_id", "fov", "noise"};
  static constexpr std::string_view kCones[] = {"scount", "spose[]", "fov", "range", "firing", "arrays", "noise"};
  static constexpr std::string_view kBeams[] = {
      "preset", "channels", "columns", "fov_v",   "range",     "pose6",   "noise",           "fov",        "resolution",
      "rgb",    "normals",  "samples", "detects", "gyro_bias", "targets", "detection_range", "depth_noise"};
  static constexpr std::string_view kComputed[] = {"type",   "inputs",   "most",   "agility", "speed",
                                                   "extent", "shortest", "widest", "objects"};
  static constexpr SensorKeyword kWords[] = {kLaserWords[0],
                                             kLaserWords[1],
                                             {"laneedge", kAny},
                                             {"magnetometer", kAny},
                                             {"occupancy", kShippedMap},
                                             {"bumper", kFelt},
                                             {"cliff", kFelt},
                                             {"encoder", kFelt},
                                             {"irreceiver", kFelt},
                                             {"gyro", kFelt},
                                             {"gps", kFelt},
                                             {"sonar", kCones},
                                             {"infrared", kCones},
                                             {"lightsensor", kFelt},
                                             {"battery", kFelt},
                                             {"analog", kFelt},
                                             {"ptz", kFelt},
                                             {"fiducial", kSeen},
                                             {"lidar", kBeams},
                                             {"camera", kBeams},
                                             {"imu", kBeams},
                                             {"radar", kBeams},
                                             {"localization", kComputed, {}, true},
                                             {"features", kComputed, {}, true},
                                             {"tracks", kComputed, {}, true}};
  LoadOptions options;
  options.sensors = kWords;
  options.controllers = [] { return std::vector<std::string_view>{"cruise", "wander"}; };
  return load_world(SF_SOURCE_DIR "/worlds/" + name, options);
}

TEST(Shipped, EveryWorldLoadsWithoutAWarning) {
  int worlds = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SF_SOURCE_DIR "/worlds")) {
    if (entry.path().extension() != ".world") continue;
    const std::string name = std::filesystem::relative(entry.path(), SF_SOURCE_DIR "/worlds").string();
    EXPECT_EQ(warnings_of(shipped(name)), "") << name;
    ++worlds;
  }
  EXPECT_GE(worlds, 6);
}

TEST(Shipped, TestPathIsThatOfTheThesis) {
  const World world = shipped("testpath/testpath.world");
  double straight = 0.0;
  for (const LaneMarking& stripe : world.lane_markings)
    if (stripe.line.size() == 2) straight += length(stripe.line[1] - stripe.line[0]);
  EXPECT_NEAR(straight, 2 * (2.72 + 1.349), 1e-12);
  EXPECT_EQ(world.magnets.size(), 78u);
  ASSERT_EQ(world.movers.size(), 1u);
  EXPECT_EQ(world.movers[0].sensors.size(), 2u);
}

TEST(Shipped, MappingAreaIsThreeMetresWide) {
  const World world = shipped("mapping/mapping.world");
  EXPECT_NEAR(world.extent.x_max - world.extent.x_min, 3.08, 1e-12) << "walls of 4 cm around";
  EXPECT_NEAR(world.extent.y_max - world.extent.y_min, 3.08, 1e-12);
}

TEST(Shipped, SimVilleHasABridgeAndMagnets) {
  const World world = shipped("simville/simville.world");
  EXPECT_GT(world.magnets.size(), 300u);
  bool bridge = false;
  for (const Segment& wall : world.walls)
    bridge = bridge || (world.models[wall.model].name == "bridge" && wall.z_min > 0.3);
  EXPECT_TRUE(bridge);
  const Ground ground(world.ramps);
  for (const double x : {6.4, 7.2, 8.0})
    for (const double y : {3.25, 3.75}) EXPECT_NEAR(ground.height({x, y}, 1.0), 0.4, 1e-6) << "the deck's top";
  EXPECT_EQ(ground.height({4.0, 3.25}, 1.0), 0.0) << "the ramp's foot";
  EXPECT_LT(ground.height({9.5, 3.25}, 1.0), 0.03);
  const auto top = std::ranges::max(world.magnets, {}, &Magnet::z).z;
  EXPECT_NEAR(top, 0.4 - 0.05, 1e-6) << "magnets are in the road";
  EXPECT_EQ(world.movers.size(), 8u);
  ASSERT_EQ(world.emitters.size(), 2u);
  EXPECT_EQ(world.emitters[0].kind, Emitter::Kind::dock);
  EXPECT_EQ(world.emitters[1].kind, Emitter::Kind::virtual_wall);
}

/// Of each pair of lights on crossing arms, at most one may be green or yellow at a time.
TEST(Shipped, SimVilleLightsNeverReleaseCrossingArms) {
  const World world = shipped("simville/simville.world");
  ASSERT_EQ(world.lights.size(), 7u);
  const auto may_go = [&](const char* point, double time) {
    for (const Light& light : world.lights)
      if (std::find(light.points.begin(), light.points.end(), point) != light.points.end())
        return signal_at(light, time).state != LightState::red;
    ADD_FAILURE() << point << " has no light";
    return false;
  };
  int all_red = 0, released = 0;
  for (double time = 0.0; time < 48.0; time += 0.1) {
    for (const char* along : {"6.1.3", "7.2.4"})
      for (const char* across : {"10.2.3", "11.1.3"}) EXPECT_FALSE(may_go(along, time) && may_go(across, time)) << time;
    for (const char* along : {"3.1.11", "4.2.5"}) EXPECT_FALSE(may_go(along, time) && may_go("12.1.7", time)) << time;
    const bool any = may_go("6.1.3", time) || may_go("10.2.3", time);
    ++(any ? released : all_red);
  }
  EXPECT_NEAR(all_red, 80, 4) << "2 s of red for all, twice in 24 s";
  EXPECT_NEAR(released, 400, 4);
}

TEST(Shipped, SimVilleLightsAreAtTheirStopLinesAndFaceTraffic) {
  const World world = shipped("simville/simville.world");
  std::vector<Warning> warnings;
  const RoadNetwork roads = load_roads(world.road_files.at(0), warnings);
  for (const Light& light : world.lights) {
    ASSERT_EQ(light.points.size(), 1u);
    for (const StopLine& stop : roads.stops) {
      if (point_id_text(id_of(roads, stop.at)) != light.points[0]) continue;
      const glm::dvec2 p = position_of(roads, stop.at);
      EXPECT_LT(std::hypot(p.x - light.X_WL.x, p.y - light.X_WL.y), 0.5) << light.name;
      EXPECT_NEAR(std::abs(base::wrap_angle(*yaw_of(roads, stop.at) - light.X_WL.yaw)), M_PI, 0.01) << light.name;
    }
  }
}

TEST(Shipped, RobotsMatchTheirDataSheets) {
  const World world = read_world(R"(include "robots.inc"
    create( name "roomba3" ) pioneer3at( name "pioneer4" pose [1 0 0 0] ) khepera2( name "khepera5" pose [2 0 0 0] ))");
  EXPECT_EQ(warnings_of(world), "");
  const Mover& create = world.movers.at(0);
  EXPECT_EQ(create.id, 3u);
  EXPECT_EQ(create.max_forward, 0.5);
  EXPECT_EQ(create.track, 0.258);
  EXPECT_EQ(create.actuator_model, ActuatorModel::direct);
  EXPECT_LT(create.max_acceleration, HUGE_VAL);
  const Mover& pioneer = world.movers.at(1);
  EXPECT_EQ(pioneer.id, 4u);
  EXPECT_EQ(pioneer.drive, Drive::skid);
  EXPECT_EQ(pioneer.max_forward, 1.2);
  EXPECT_DOUBLE_EQ(pioneer.max_turn, 300.0 * M_PI / 180.0);
  EXPECT_EQ(pioneer.body.size(), 8u);
  const World cars = read_world(R"(include "robots.inc"
    family_car( ) small_car( pose [9 0 0 0] ) pioneer3at_dynamic( pose [20 0 0 0] ))");
  EXPECT_EQ(warnings_of(cars), "");
  for (const Mover& car : cars.movers) EXPECT_EQ(car.dynamics.name, "car");
  EXPECT_EQ(cars.movers.at(0).drive, Drive::car);
  EXPECT_EQ(cars.movers.at(2).dynamics.settings.at(0).second, "pioneer");
  const Mover& khepera = world.movers.at(2);
  EXPECT_EQ(khepera.id, 5u);
  EXPECT_NEAR(khepera.radius, 0.035, 1e-6);
  EXPECT_EQ(khepera.track, 0.052);
}

}  // namespace
}  // namespace sf::world
