// Common tests of sensor types without device work: equal bytes for any number of threads, no allocation when warm.
// Also tests all types without a device: the host produces the bytes of the kernels, and rejects requests that require
// a kernel.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>

#include "base/error.h"
#include "raycast/casters.h"
#include "sensors/analog.h"
#include "sensors/bumper.h"
#include "sensors/cliff.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/irreceiver.h"
#include "sensors/lightsensor.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/host_trial.h"
#include "tests/sensors/laneedge_trial.h"
#include "tests/sensors/magnet_scenes.h"
#include "tests/sensors/scenes.h"
#include "tests/world/read_world.h"

namespace sf::trial {
namespace {

/// Robots with one sensor of each type, a roof, walls, a hole and a dock.
world::World everything(int robots) {
  world::World world;
  for (int i = 0; i < robots; ++i) {
    const auto m = scenes::add_carrier(world, {0.1 * i, 0.05 * i, 0, 0.3 * i}, fitted("bumper"));
    auto& sensors = world.movers[m].sensors;
    sensors.push_back(fitted("cliff"));
    sensors.push_back(fitted("encoder", {setting("slip", {0.01}), setting("per_count", {1e-6})}));
    sensors.push_back(fitted("gyro", {setting("noise", {0.1}), setting("bias", {0.1})}));
    sensors.push_back(fitted("gps", {setting("noise", {1}), setting("rate", {10})}));
    sensors.push_back(fitted("imu", {setting("gyro_noise", {0.1}), setting("accel_instability", {0.1})}));
    sensors.push_back(fitted("compass", {setting("noise", {1e-6})}));
    sensors.push_back(fitted("altimeter", {setting("walk", {0.1})}));
    sensors.push_back(fitted("inclinometer", {setting("bias", {1})}));
    sensors.push_back(fitted("irreceiver"));
    sensors.push_back(fitted("lightsensor"));
    sensors.push_back(fitted("battery"));
    sensors.push_back(fitted("fiducial", {setting("noise", {0.1, 1, 1})}));
    world::Setting input = setting("input[0]", {0.01});
    input.text = "light";
    sensors.push_back(fitted("analog", {input}));
    sensors.push_back(fitted(
        "ptz", {setting("views", {2}), setting("view[0]", {-20, 0, 40, 0.1}), setting("view[1]", {20, 0, 20, 0.1})}));
  }
  add_solid(world, square({2, 1}, 1.5), 0.5, 0.6);
  add_solid(world, square({4, 1}, 0.2), 0.0, 2.0);
  world.floor_holes.push_back({square({1, 0.5}, 0.7), 0});
  world.emitters.push_back({world::Emitter::Kind::dock, world::kNone, {3, 1, 0, 0}, 2.0, 0.7, 0.5});
  world.lamps.push_back({world::kNone, {4, 3, 1, 0}, 100.0});
  return world;
}

std::vector<base::Report> moved(const world::World& world, int tick) {
  std::vector<base::Report> states = robots::states_at_load(world);
  for (base::Report& s : states) {
    s.X_WM.x += 0.02 * (tick % 8);
    s.X_WM.yaw += 0.1 * (tick % 8);
    s.velocity.turn = 0.1 * tick;
    s.contact_mask = static_cast<std::uint32_t>(tick) << s.mover % 8;
  }
  return states;
}

std::uint64_t hash_of(const world::World& world, const farm::FarmOptions& options) {
  farm::Farm farm(world, device(), options);
  farm.subscribe_all();
  for (int tick = 0; tick < 30; ++tick) farm.tick(tick * 100'000'000ll, moved(world, tick));
  return farm.hash();
}

TEST(HostKinds, SameBytesForAnyThreads) {
  const world::World world = everything(200);
  const std::uint64_t one = hash_of(world, {.seed = 1, .threads = 1});
  for (const unsigned threads : {2u, 3u}) EXPECT_EQ(hash_of(world, {.seed = 1, .threads = threads}), one);
  EXPECT_NE(hash_of(world, {.seed = 2}), one);
}

/// A robot's readings do not depend on other robots.
TEST(HostKinds, DoNotDependOnOtherRobots) {
  const world::World few = everything(3), many = everything(50);
  farm::Farm a(few, device(), {.seed = 1}), b(many, device(), {.seed = 1});
  a.subscribe_all();
  b.subscribe_all();
  for (int tick = 0; tick < 5; ++tick) {
    std::vector<std::vector<double>> first, second;
    for (const auto& r : a.tick(tick * 100'000'000ll, moved(few, tick))) first.push_back(values_of(r));
    for (const auto& r : b.tick(tick * 100'000'000ll, moved(many, tick)))
      if (r.mover < 3) second.push_back(values_of(r));
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t k = 0; k < first[i].size(); ++k)
        EXPECT_TRUE(first[i][k] == second[i][k] || (std::isnan(first[i][k]) && std::isnan(second[i][k])));
  }
}

/// All types, with those of the device: robots that rise and sink read as if loaded at their heights.
TEST(HostKinds, FollowTheHeightsOfTheirRobots) {
  world::World world = everything(6);
  for (std::uint32_t m = 0; m < 6; ++m) {
    for (const char* const type : {"laser", "sonar", "infrared"}) world.movers[m].sensors.push_back(fitted(type));
    world.movers[m].sensors.push_back(scenes::five());
    world.movers[m].magnets.push_back({{0.1, 0.0}, 0.05, 1.0, 0.01, 0});
  }
  world.magnets.push_back({{1.0, 0.5}, 0.0, 1.0, 0.01, 0});
  farm::Farm farm(world, device(), {.seed = 1});
  farm.subscribe_all();
  for (int tick = 0; tick < 4; ++tick) {
    std::vector<base::Report> states = moved(world, tick);
    world::World now = world;
    for (std::uint32_t m = 0; m < 6; ++m) {
      states[m].X_WM.z = 0.07 * ((tick + m) % 4) - 0.05;
      now.movers[m].X_WM.z = states[m].X_WM.z;
    }
    farm::Farm loaded(now, device(), {.seed = 1});
    loaded.subscribe_all();
    for (int before = 0; before < tick; ++before) loaded.tick(before * 100'000'000ll, moved(world, before));
    expect_same_bits(farm.tick(tick * 100'000'000ll, states), loaded.tick(tick * 100'000'000ll, states));
  }
}

TEST(HostKinds, CanBeSensedAtAnyPose) {
  const world::World world = everything(2);
  farm::Farm farm(world, device());
  const auto sense = [&](std::uint8_t type) { return farm.sense(1, type, 0, {100, 100, 0, 1}); };
  EXPECT_EQ(sense(sensors::kGps).values[3], 8.0);
  EXPECT_EQ(sense(sensors::kEncoder).values[2], 0.0);
  EXPECT_EQ(sense(sensors::kBumper).values[0], 0.0);
  EXPECT_EQ(sense(sensors::kIrReceiver).values[1], 255.0);
  EXPECT_EQ(sense(sensors::kGps).X_WS.x, 100.0);
}

/// Returns readings of robot `mover` of one sensor type, by sensor.
std::vector<std::vector<double>> of(std::span<const base::ReadingBlock> readings, std::uint8_t type,
                                    std::uint32_t mover) {
  std::vector<std::vector<double>> all;
  for (const base::ReadingBlock& r : readings)
    if (r.type == type && r.mover == mover) all.push_back(values_of(r));
  return all;
}

/// Every sensor has its own settings and its own robot's state: the first robot has no sensors, the third two of each
/// type.
TEST(HostKinds, SensorsAreIndependent) {
  world::World world = carriers(fitted("bumper"), {{0, 0, 0, 0}, {10, 0, 0.5, 0}, {20, 0, 0, 0}});
  const auto fit = [&](std::size_t m, const char* type, std::vector<world::Setting> settings) {
    world.movers[m].sensors.push_back(fitted(type, std::move(settings)));
  };
  for (world::Mover& mover : world.movers) mover.sensors.clear();
  fit(1, "encoder", {setting("per_count", {1e-2})});
  fit(2, "encoder", {setting("scale", {3, 2})});
  fit(2, "encoder", {});
  fit(1, "gyro", {setting("range", {90})});
  fit(2, "gyro", {});
  fit(2, "gyro", {setting("range", {180})});
  fit(1, "bumper", {setting("zone[0]", {0, 90})});
  fit(2, "bumper", {setting("zone[0]", {-90, 0})});
  fit(2, "bumper", {});
  fit(1, "cliff", {setting("spose[0]", {0.5, 0, 0})});
  fit(2, "cliff", {setting("spose[0]", {-0.5, 0, 0})});
  fit(2, "cliff", {setting("spose[0]", {0, 0.5, 0})});
  fit(1, "gps", {setting("satellites", {8})});
  fit(2, "gps", {setting("satellites", {16})});
  fit(2, "gps", {setting("satellites", {12})});
  world.floor_holes = {{square({10.5, 0}, 0.5), 0}, {square({19.5, 0}, 0.5), 0}};
  add_solid(world, square({10, 0}, 30.0), 0.3, 0.4);  // over the third robot, under the second
  farm::Farm farm(world, device());
  farm.subscribe_all();
  farm.tick(0, {});
  std::vector<base::Report> states = robots::states_at_load(world);
  for (base::Report& s : states) {
    s.X_WM.x += 0.1 * s.mover;
    s.velocity.turn = 2.0 * (s.mover + 1.0);
  }
  states[0].contact_mask = 0xFFFFFFFFu;
  states[1].contact_mask = 1u;
  states[2].contact_mask = 1u << 20;
  const auto readings = farm.tick(1'000'000'000, states);
  using All = std::vector<std::vector<double>>;
  EXPECT_EQ(of(readings, sensors::kEncoder, 1), (All{{0.1, 0.1, 10, 10}}));
  EXPECT_EQ(of(readings, sensors::kEncoder, 2), (All{{0.6, 0.4, 600, 400}, {0.2, 0.2, 200, 200}}));
  EXPECT_EQ(of(readings, sensors::kGyro, 1), (All{{M_PI / 2}}));
  EXPECT_EQ(of(readings, sensors::kGyro, 2), (All{{6.0}, {M_PI}}));
  EXPECT_EQ(of(readings, sensors::kBumper, 1), (All{{1}}));
  EXPECT_EQ(of(readings, sensors::kBumper, 2), (All{{0}, {1}}));
  EXPECT_EQ(of(readings, sensors::kCliff, 1), (All{{1}}));
  EXPECT_EQ(of(readings, sensors::kCliff, 2), (All{{1}, {0}}));
  const auto seen = [&](std::uint32_t m, std::size_t i) { return of(readings, sensors::kGps, m)[i][3]; };
  EXPECT_EQ(seen(1, 0), 8.0) << "above the roof, half a metre up";
  EXPECT_EQ(seen(2, 0), 0.0);
  EXPECT_EQ(seen(2, 1), 0.0);
  EXPECT_TRUE(of(readings, sensors::kGps, 0).empty());
}

/// Errors of two sensors of one type on a robot are independent.
TEST(HostKinds, TwoOfATypeHaveIndependentErrors) {
  world::World world = carriers(fitted("gyro", {setting("bias", {1.0})}));
  const auto fit = [&](const char* type, const char* key) {
    for (int i = 0; i < 2; ++i) world.movers[0].sensors.push_back(fitted(type, {setting(key, {0.5})}));
  };
  world.movers[0].sensors.clear();
  fit("gyro", "bias");
  fit("gps", "noise");
  fit("encoder", "slip");
  for (world::Sensor& s : world.movers[0].sensors)
    if (s.type == "encoder") s.settings.push_back(setting("per_count", {1e-6}));
  farm::Farm farm(world, device(), {.seed = 3});
  farm.subscribe_all();
  farm.tick(0, {});
  std::vector<base::Report> states = robots::states_at_load(world);
  states[0].X_WM.x = 0.3;
  const auto readings = farm.tick(1'000'000'000, states);
  for (const std::uint8_t type : {sensors::kGyro, sensors::kGps, sensors::kEncoder}) {
    const auto pair = of(readings, type, 0);
    ASSERT_EQ(pair.size(), 2u);
    EXPECT_NE(pair[0][0], pair[1][0]) << int{type};
    EXPECT_GT(std::abs(pair[0][0] - pair[1][0]), 1e-5) << int{type};
  }
}

/// Phase, latency and names apply to all sensors.
TEST(HostKinds, LatencyDelaysReadings) {
  const world::World world = carriers(fitted("gyro", {setting("latency", {0.15})}));
  farm::Farm farm(world, device());
  farm.subscribe_all();
  for (int tick = 0; tick < 10; ++tick) {
    const auto readings = farm.tick(tick * 100'000'000ll, {});
    ASSERT_EQ(readings.size(), tick < 2 ? 0u : 1u) << tick;
    EXPECT_TRUE(tick < 2 || readings[0].time == (tick - 2) * 100'000'000ll);
  }
}

/// Returns a world file with a robot of `sensors` from robots.inc.
world::World ready_made(const std::string& sensors) {
  const std::string file = testing::TempDir() + "ready_made.world";
  std::ofstream(file) << "include \"" SF_SOURCE_DIR "/worlds/robots.inc\"\ncreate( name \"one\" " << sensors << ")\n";
  return world::load_world(file, {.sensors = sensors::world_file_words()});
}

/// `noise` and `resolution` are known where they have an effect: each type that knows one refuses a text as its value.
TEST(HostKinds, KeysWithoutEffectAreWarnedOf) {
  std::size_t with = 0, without = 0;
  for (const world::SensorKeyword& word : sensors::world_file_words())
    for (const std::string key : {"noise", "resolution"}) {
      if (word.derived) continue;
      const std::string text = "position( ctrl \"none\" " + std::string(word.type) + "( " + key + " \"x\" scount 1 ) )";
      const world::World world = world::build_world("a.world", text, {.sensors = sensors::world_file_words()});
      const bool warned = world::warnings_of(world).find("unknown property '" + key + "'") != std::string::npos;
      const bool knows = std::ranges::find(word.keys, key) != word.keys.end();
      ++(knows ? with : without);
      EXPECT_NE(warned, knows) << text << world::warnings_of(world);
      if (knows) {
        EXPECT_THROW(sensors::SensorSet{world}, base::InputError) << text;
      }
    }
  EXPECT_GE(with, 10u);
  EXPECT_GE(without, 20u);
}

TEST(HostKinds, PredefinedSensorsAreRead) {
  const world::World world = ready_made(
      "create_bumper() create_cliff() create_irreceiver() create_encoder() pioneer_bumpers() pioneer_encoder() "
      "khepera_encoder() mems_gyro() outdoor_gps() create_battery() pioneer_battery() khepera_battery() "
      "khepera_light() "
      "khepera_analog() pioneer_analog() pioneer_ptz()");
  EXPECT_TRUE(world.warnings.empty());
  const sensors::SensorSet sensor_set(world);
  EXPECT_EQ(sensor_set.count(), 16u);
  EXPECT_EQ(sensor_set.of(sensors::kLightSensor, 0)[0].elements, 8u);
  EXPECT_EQ(sensor_set.of(sensors::kAnalog, 0)[1].elements, 8u);
  EXPECT_EQ(sensor_set.of(sensors::kBumper, 0)[0].elements, 2u);
  EXPECT_EQ(sensor_set.of(sensors::kBumper, 0)[1].elements, 10u);
  EXPECT_EQ(sensor_set.of(sensors::kCliff, 0)[0].elements, 4u);
  EXPECT_EQ(sensor_set.of(sensors::kEncoder, 0).size(), 3u);
  EXPECT_EQ(sensor_set.of(sensors::kGps, 0)[0].latency, 0.1);
  EXPECT_NEAR(sensor_set.of(sensors::kIrReceiver, 0)[0].X_MS.z, 0.09, 1e-12);
  EXPECT_NEAR(sensor_set.of(sensors::kGps, 0)[0].X_MS.z, 0.12, 1e-12) << "the antenna is on top";

  const auto& fitted = world.movers[0].sensors;
  const auto create = sensors::read_bumper(fitted[0]), pioneer = sensors::read_bumper(fitted[4]);
  EXPECT_EQ(create[0] & create[1], 0x80000001u) << "both switches meet straight ahead";
  EXPECT_EQ(create[0] | create[1], 0xFF0000FFu) << "the front half";
  std::uint32_t all = 0;
  for (const std::uint32_t panel : pioneer) {
    EXPECT_EQ(std::popcount(panel), 2);
    EXPECT_EQ(all & panel, 0u);
    all |= panel;
  }
  EXPECT_DOUBLE_EQ(sensors::read_encoder(fitted[5], world.movers[0]).track, 1.5 * 0.394);
  EXPECT_DOUBLE_EQ(sensors::read_encoder(fitted[6], world.movers[0]).per_count, 1e-3 / 12);
}

const farm::FarmOptions kWithoutDevice{.scene = {.caster = &raycast::host_caster}};

/// Compares two farms of one world, with noise, that receive the same states.
void expect_same_readings(const world::World& world, const raycast::CasterType* caster, int ticks = 4) {
  farm::Farm kernels(world, device(), {.scene = {.caster = caster}}), host(world, host_device(), kWithoutDevice);
  kernels.subscribe_all(), host.subscribe_all();
  Chance chance(3);
  std::size_t readings = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    std::vector<base::Report> reports;
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
      const base::Pose& X = world.movers[m].X_WM;
      reports.push_back(
          {m, 0, {X.x + chance.between(-0.3, 0.3), X.y + chance.between(-0.3, 0.3), 0.0, chance.between(-4, 4)}, {}});
    }
    const auto by_kernels = kernels.tick(tick * 1'000'000'000ll, reports);
    readings += by_kernels.size();
    expect_same_bits(host.tick(tick * 1'000'000'000ll, reports), by_kernels);
  }
  EXPECT_GT(readings, 0u);
  EXPECT_EQ(host.hash(), kernels.hash());
  EXPECT_EQ(host.stats().batches, 0u) << "nothing is submitted";
}

/// Paint at random, with walls and robots in front of it, and every kind of scan: one beam, few in one lane, many with
/// noise.
world::World rasters(double resolution, bool with_bodies, std::uint64_t seed) {
  Chance chance(seed);
  world::World world = with_bodies ? scenes::boxes(6, 6.0, seed) : world::World{};
  world.road_resolution = resolution;
  for (int i = 0; i < 12; ++i)
    world.lane_markings.push_back(marking(chance.in_square(2.5), chance.in_square(2.5), chance.between(0.02, 0.2)));
  add_dashes(world, {-2.5, 0.3}, {2.5, 0.3}, 0.1, 0.3, 0.2);
  if (with_bodies) scenes::add_robots(world, 6, scenes::laser(3), seed);
  for (int i = 0; i < 60; ++i) {
    const glm::dvec2 p = chance.in_square(i % 10 == 9 ? 40.0 : 3.0);                         // some are far from all
                                                                                             // paint
    const double yaw = i % 4 == 0 ? 0.5 * M_PI * (i / 4 % 4) : chance.between(-M_PI, M_PI);  // some are along pixels
    Settings settings{{"samples", {static_cast<double>(1 + i % 7 * (i % 5) * 9)}}, {"range_max", {1.0 + i % 3}}};
    if (i % 2 == 1) settings.push_back({"noise", {0.01, 0.002, i % 4 == 1 ? 0.5 : 0.0}});
    add_edge_eye(world, {p.x, p.y, 0.0, yaw}, settings);
  }
  return world;
}

TEST(HostDevice, LaneEdgesOnRastersHaveTheBytesOfTheKernels) {
  for (const double resolution : {0.002, 0.005, 0.02, 0.13})
    for (const bool with_bodies : {false, true})
      for (const auto caster : {&raycast::host_caster, &raycast::device_caster})
        expect_same_readings(rasters(resolution, with_bodies, 7), caster);
}

TEST(HostDevice, MagnetometersHaveTheBytesOfTheKernelsInAllModes) {
  for (const bool sum : {false, true}) {
    world::World world = scenes::sheet(20'000, 8.0, 5, true);
    if (sum) world.earth_field = {2e-5, 1e-6, -4.5e-5};
    Chance chance(6);
    for (const std::string_view mode : {"exact", "near1", "near3", "near10"})
      for (int elements = 1; elements <= 7; ++elements) {
        std::vector<base::Pose> at;
        for (int e = 0; e < elements; ++e) at.push_back({0.1, 0.05 * e, 0.01 * e, 0.3 * e});
        world::Sensor sensor = scenes::array(at);
        sensor.settings.push_back(scenes::text("accuracy", std::string(mode)));
        sensor.settings.push_back(scenes::setting("noise", {1e-7}));
        if (sum) sensor.settings.push_back(scenes::text("sum", "magnitude"));
        const glm::dvec2 p = chance.in_square(3.0);
        const auto row = scenes::add_carrier(world, {p.x, p.y, 0.0, 0.0}, sensor);
        world.movers[row].magnets.push_back(scenes::magnet({0.1, 0.0}, 0.05, 2.0));
      }
    expect_same_readings(world, nullptr);
  }
}

/// Types without subscribers are not prepared and collect nothing.
TEST(HostDevice, EachTypeCanBeReadAlone) {
  world::World world = rasters(0.01, true, 4);
  scenes::add_carrier(world, {}, scenes::five());
  scenes::add_carrier(world, {}, fitted("sonar"));
  world.magnets.push_back(scenes::magnet({0.2, 0.0}));
  const sensors::SensorSet all(world);
  ASSERT_GE(all.groups().size(), 4u);
  for (const auto& group : all.groups()) {
    farm::Farm farm(world, host_device(), kWithoutDevice);
    for (std::uint32_t m = 0; m < world.movers.size(); ++m) farm.subscribe(m, 1u << group.type->id);
    EXPECT_EQ(farm.tick(0, {}).size(), group.rows.size()) << group.type->name;
  }
}

TEST(HostDevice, RejectsTheCasterOfKernels) {
  world::World world = scenes::boxes(2, 6.0, 1);
  scenes::add_robots(world, 1, scenes::laser(), 1);
  expect_in("mesa-vulkan-drivers", refusal_of<base::DeviceError>([&] {
              const farm::Farm farm(world, host_device(), {.scene = {.caster = &raycast::device_caster}});
            }));
}

}  // namespace
}  // namespace sf::trial
