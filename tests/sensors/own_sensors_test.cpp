#include "sensors/own_sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/error.h"
#include "base/random.h"
#include "farm/farm.h"
#include "sensors/laser.h"
#include "shaders/test_openness.comp.h"
#include "tests/device.h"
#include "tests/refusal.h"
#include "tests/sensors/host_trial.h"
#include "world/stage/build_world.h"

namespace sf::sensors {
namespace {

using Values = std::span<double>;
using Read = std::function<void(const sensorfarm::Measurement&, Values)>;

struct ScriptedSensor : sensorfarm::Sensor {
  std::uint32_t rows = 1;
  double range = 0.0;
  Read read_values;
  std::uint32_t elements() const override { return rows; }
  std::array<double, 8> parameters() const override { return {range}; }
  void read(const sensorfarm::Measurement& m, Values values) const override { read_values(m, values); }
};

/// Actions of the next sensors of a type; types stay registered for the whole program.
std::map<std::string, Read> reads;

void add_type(const std::string& name, std::uint8_t id, const std::string& kernel = "") {
  if (reads.contains(name)) return;
  reads[name] = [](const auto&, Values) {};
  add_own_sensor({.name = name,
                  .id = id,
                  .columns = {{"first_m", 1e-3}, {"second", 1.0}},
                  .keys = {"rows", "range_max"},
                  .rate = 20.0,
                  .kernel = kernel,
                  .make =
                      [name](const sensorfarm::SensorSite& site, const sensorfarm::SensorSettings& settings) {
                        auto made = std::make_unique<ScriptedSensor>();
                        made->rows = static_cast<std::uint32_t>(settings.number("rows", 1, 0, 1e6));
                        made->range = settings.length("range_max", 4.0, 0.1, 100.0);
                        made->read_values = [name](const auto& m, Values values) { reads[name](m, values); };
                        if (site.name == "refused") throw std::invalid_argument("not this one");
                        return made;
                      }},
                 "test");
}

world::World world_with(const std::string& sensor) {
  return world::build_world("own.world", R"(
model( name "wall" pose [2 0 0 0] size [0.1 4 1] )
model( name "low" pose [0 2 0 0] size [4 0.1 0.02] )
position( name "r0" size [0.3 0.3 0.1]
)" + sensor + " )",
                            {.sensors = world_file_words()});
}

TEST(OwnSensors, UseTheirOwnRateRowsAndPose) {
  add_type("scripted", 20);
  reads["scripted"] = [](const sensorfarm::Measurement& m, Values values) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) + m.X_WS.z;
    values[0] = m.time;
  };
  const world::World world = world_with("scripted( rows 3 pose [0.1 0 0.05 90] )");
  farm::Farm farm(world, device()), on_host(world, host_device());
  farm.subscribe_all(), on_host.subscribe_all();
  const auto reports = robots::states_at_load(world);
  ASSERT_EQ(on_host.tick(0, reports).size(), 1u);
  ASSERT_EQ(farm.tick(0, reports).size(), 1u);
  EXPECT_EQ(farm.tick(49'000'000, reports).size(), 0u);
  const auto readings = farm.tick(50'000'000, reports);
  ASSERT_EQ(readings.size(), 1u);
  EXPECT_EQ(readings[0].type, 20);
  EXPECT_NEAR(readings[0].X_WS.yaw, M_PI / 2, 1e-12);
  ASSERT_EQ(readings[0].values.size(), 6u);
  EXPECT_EQ(readings[0].values[0], 0.05);
  EXPECT_EQ(readings[0].values[5], 5.0 + readings[0].X_WS.z);
  EXPECT_TRUE(std::ranges::equal(on_host.tick(50'000'000, reports)[0].values, readings[0].values));
}

TEST(OwnSensors, CastLikeLasers) {
  add_type("scripted", 20);
  world::World world = world::load_world(SF_SOURCE_DIR "/worlds/cave.world", {.sensors = world_file_words()});
  world::clone_robots(world, 30, 5);
  // One of the user's sensors on each robot, at the pose of its laser.
  const world::World donor = world_with("scripted( )");
  for (world::Mover& mover : world.movers) {
    world::Sensor own = donor.movers[0].sensors[0];
    own.X_MS = mover.sensors[0].X_MS;
    own.X_MS.z += mover.sensors[0].height / 2.0;
    own.height = 0.0;
    mover.sensors.push_back(own);
  }
  world::update_extent_and_hash(world);
  reads["scripted"] = [](const sensorfarm::Measurement& m, Values values) {
    const sensorfarm::Hit hit = m.around.cast(m.X_WS.x, m.X_WS.y, m.X_WS.z, m.X_WS.yaw, 8.0);
    values[0] = hit.range, values[1] = hit.model;
  };
  farm::Farm farm(world, device());
  farm.subscribe_all();
  const auto reports = robots::states_at_load(world);
  std::vector<double> ranges(world.movers.size()), cast(world.movers.size());
  for (const base::ReadingBlock& reading : farm.tick(0, reports)) {
    if (reading.type == kLaser) ranges[reading.mover] = reading.values[reading.values.size() / 2];
    if (reading.type == 20) cast[reading.mover] = reading.values[0];
  }
  for (std::size_t m = 0; m < cast.size(); ++m) EXPECT_NEAR(cast[m], ranges[m], 1e-12) << m;
}

TEST(OwnSensors, SeeRobotsExceptTheirOwnAndNothingBelow) {
  add_type("scripted", 20);
  std::vector<sensorfarm::Hit> hits;
  reads["scripted"] = [&](const sensorfarm::Measurement& m, Values) {
    for (const double bearing : {0.0, M_PI / 2, M_PI, -M_PI / 2})
      hits.push_back(m.around.cast(m.X_WS.x, m.X_WS.y, m.X_WS.z, bearing, 3.0));
  };
  const world::World world = world_with(R"(scripted( pose [0 0 0.05 0] ) )
position( name "r1" size [0.3 0.3 0.4] pose [0 -1 0 0] )");
  farm::Farm farm(world, device());
  farm.subscribe_all();
  farm.tick(0, robots::states_at_load(world));
  ASSERT_EQ(hits.size(), 4u);
  EXPECT_NEAR(hits[0].range, 1.95, 1e-12);
  EXPECT_EQ(world.models[hits[0].model].name, "wall");
  EXPECT_EQ(hits[1].range, 3.0);  // the wall of 2 cm is below
  EXPECT_EQ(hits[1].model, sensorfarm::kNone);
  EXPECT_EQ(hits[2].range, 3.0);
  EXPECT_NEAR(hits[3].range, 0.85, 1e-12);
  EXPECT_EQ(world.models[hits[3].model].name, "r1");
}

TEST(OwnSensors, NoiseDependsOnlyOnSeedAndReading) {
  add_type("scripted", 20);
  std::vector<double> drawn;
  reads["scripted"] = [&](const sensorfarm::Measurement& m, Values) { drawn.push_back(m.around.normal(0)[0]); };
  const world::World world = world_with("scripted( )");
  const auto reports = robots::states_at_load(world);
  const auto draw = [&](const farm::FarmOptions& options) {
    drawn.clear();
    farm::Farm farm(world, device(), options);
    farm.subscribe_all();
    for (int k = 0; k < 3; ++k) farm.tick(k * 50'000'000, reports);
    return drawn;
  };
  const auto first = draw({.seed = 1});
  EXPECT_EQ(draw({.seed = 1}), first);
  EXPECT_NE(draw({.seed = 2}), first);
  EXPECT_NE(first[0], first[1]);
  EXPECT_EQ(draw({.seed = 1, .noise = false}), std::vector<double>(3, 0.0));
}

TEST(OwnSensors, KernelsMeasureAndTheHostMayFinish) {
  const auto file = std::filesystem::temp_directory_path() / "sensorfarm_openness.spv";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(test_openness_comp_spv), sizeof test_openness_comp_spv);
  add_type("openness", 21, file.string());
  reads["openness"] = [](const sensorfarm::Measurement&, Values values) { values[1] = 7.0; };
  // Four sensors of different lengths, so that invocations without work lie between those with work.
  const world::World world = world_with(
      "openness( rows 4 pose [0 0 0.05 0] ) openness( rows 1 ) openness( rows 100 pose [0 0 0.05 0] ) openness( rows 2 "
      ")");
  farm::Farm farm(world, device());
  farm.subscribe_all();
  for (int k = 0; k < 2; ++k) {
    const auto readings = farm.tick(k * 100'000'000, robots::states_at_load(world));
    ASSERT_EQ(readings.size(), 4u);
    EXPECT_NEAR(readings[0].values[0], 1.95, 1e-6);  // ahead
    EXPECT_NEAR(readings[0].values[2], 4.0, 1e-6);   // to the left: range_max
    EXPECT_EQ(readings[0].values[1], 7.0);
    ASSERT_EQ(readings[2].values.size(), 200u);
    for (int i = 0; i < 100; ++i) {
      const double c = std::cos(2 * M_PI * i / 100);
      const double s = std::sin(2 * M_PI * i / 100);
      const bool meets = c > 0 && std::abs(1.95 / c * s) <= 2.0 && 1.95 / c < 4.0;
      EXPECT_NEAR(readings[2].values[2 * i], meets ? 1.95 / c : 4.0, 1e-5) << i;
    }
  }
  // No device could run it.
  const std::string error = refusal_of<base::DeviceError>([&] { const farm::Farm none(world, host_device()); });
  expect_in("(openness) has its own kernel", error);
  expect_in("mesa-vulkan-drivers", error);
  std::filesystem::remove(file);
}

TEST(OwnSensors, RejectedKernelsStateTheReason) {
  const auto add = [](const std::string& kernel) {
    return refusal_of([&] {
      add_own_sensor(
          {.name = "bad", .id = 26, .columns = {{"x"}}, .kernel = kernel, .make = [](auto&, auto&) { return nullptr; }},
          "test");
    });
  };
  expect_in("no such file", add("/nowhere.spv"));
  expect_in("is not a SPIR-V module", add(SF_SOURCE_DIR "/LICENSE"));
}

TEST(OwnSensors, RejectsSettingsWithFileAndLine) {
  add_type("scripted", 20);
  const auto make = [](const std::string& sensor) {
    return refusal_of([&] { SensorSet sensor_set(world_with(sensor)); });
  };
  expect_in("own.world:5: 'rows' is -1; expected 0 to 1000000", make("scripted( rows -1 )"));
  expect_in("own.world:5: 'range_max'", make("scripted( range_max 1000 )"));
  expect_in("own.world:5: not this one", make("scripted( name \"refused\" )"));
  EXPECT_EQ(world_with("scripted( row 1 )").warnings.size(), 1u);  // as for built-in types
}

TEST(OwnSensors, FailuresEndTheTickWithTheirMessage) {
  add_type("scripted", 20);
  reads["scripted"] = [](const auto&, Values) { throw std::runtime_error("broken lens"); };
  const world::World world = world_with("scripted( )");
  farm::Farm farm(world, device());
  farm.subscribe_all();
  expect_in("(scripted) failed at 0.000 s: broken lens",
            refusal_of([&] { farm.tick(0, robots::states_at_load(world)); }));
}

TEST(OwnSensors, TypesMustBeNewAndUsable) {
  const auto add = [](sensorfarm::SensorEntry entry) {
    entry.make = [](auto&, auto&) { return nullptr; };
    return refusal_of([&] { add_own_sensor(entry, "mine.so"); });
  };
  expect_in("mine.so: ", add({.name = "Big", .id = 26, .columns = {{"x"}}}));
  expect_in("cannot be called", add({.name = "", .id = 26, .columns = {{"x"}}}));
  expect_in("expected 13 to 26", add({.name = "mine", .id = 12, .columns = {{"x"}}}));
  expect_in("expected 13 to 26", add({.name = "mine", .id = 27, .columns = {{"x"}}}));
  expect_in("'laser' with id 1 already exists", add({.name = "laser", .id = 26, .columns = {{"x"}}}));
  expect_in("'laser' with id 1 already exists",
            add({.name = "ranger", .id = 26, .columns = {{"x"}}}));  // a keyword of world files
  expect_in("has no column", add({.name = "mine", .id = 26}));
  expect_in("a unit above 0", add({.name = "mine", .id = 26, .columns = {{"x", 0.0}}}));
  expect_in("a rate of", add({.name = "mine", .id = 26, .columns = {{"x"}}, .rate = 0.0}));
  EXPECT_EQ(find_sensor_type(26), nullptr);
}

TEST(OwnSensors, PacketsRoundTripWithinTheirUnits) {
  add_type("scripted", 20);
  const SensorType& type = *find_sensor_type(20);
  const world::World world = world_with("scripted( rows 2 )");
  const SensorSpec spec = type.parse(world).rows[0];
  const std::vector<double> values{1.23456, 3.0, -7.5, NAN};
  base::ReadingBlock reading;
  reading.values = values;
  base::Bytes bytes;
  EXPECT_EQ(type.encode(spec, reading, WireFormat::farm, 0, bytes), 20);
  EXPECT_EQ(type.decode(spec, bytes, 20, WireFormat::farm).fault, PayloadError::none);
  std::vector<double> back(4);
  type.read(spec, bytes, 20, WireFormat::farm, back);
  EXPECT_NEAR(back[0], 1.23456, 0.5e-3);
  EXPECT_EQ(back[1], 3.0);
  EXPECT_EQ(back[2], -7.5);
  EXPECT_TRUE(std::isnan(back[3]));
  const SensorSpec large = type.parse(world_with("scripted( rows 157 )")).rows[0];  // 314 numbers, one too many
  expect_in("it can be recorded, but not sent", type.wire_problem(large, WireFormat::farm));
  EXPECT_EQ(type.wire_problem(type.parse(world_with("scripted( rows 156 )")).rows[0], WireFormat::farm), "");
}

}  // namespace
}  // namespace sf::sensors
