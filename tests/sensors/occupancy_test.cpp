// Occupancy maps as a sensor type: settings, ticks, packets.

#include "sensors/occupancy.h"
#include "sensors/laser.h"

#include <gtest/gtest.h>

#include "maps/map_packets.h"
#include "tests/farm/small_farm.h"
#include "tests/refusal.h"
#include "tests/sensors/compare.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/map_scans.h"
#include "tests/sensors/scenes.h"

namespace sf::trial {
namespace {

using sensors::WireFormat;

world::Sensor map_sensor(std::vector<world::Setting> settings = {}) {
  world::Sensor sensor;
  sensor.type = "occupancy";
  sensor.name = "map";
  sensor.radians_per_unit = M_PI / 180.0;
  sensor.settings = std::move(settings);
  sensor.line = 9;
  sensor.file = "a.world";
  return sensor;
}

world::Setting numbers(const std::string& key, std::vector<double> values) {
  return {key, std::move(values), "", 12, "a.world"};
}
world::Setting text(const std::string& key, const std::string& value) { return {key, {}, value, 13, "a.world"}; }

/// Robots among boxes with the thesis' laser at 13 Hz, each with a map.
world::World mapped(std::uint32_t robots, const std::vector<world::Setting>& settings = {}) {
  world::World world = scenes::boxes(20, 12.0, 3);
  sensors::LaserSettings laser = scenes::laser(181, M_PI, 0.75);
  laser.name = "laser";
  laser.rate = 10.0;
  scenes::add_robots(world, robots, laser, 5);
  for (world::Mover& mover : world.movers) mover.sensors.push_back(map_sensor(settings));
  return world;
}

sensors::Occupancy only(const world::World& world) { return sensors::occupancies_of(world).at(0); }

void expect_map_refused(const std::vector<world::Setting>& settings, const std::string& part) {
  const std::string error = refusal_of([&] { sensors::occupancies_of(mapped(1, settings)); });
  expect_in(part, error);
  EXPECT_TRUE(error.starts_with("a.world:")) << error;
}

/// Noise may move the range of a surface that is too near into the limits. Its flag keeps it out of maps.
TEST(OccupancyTick, IgnoresSurfacesThatAreTooNear) {
  for (const double range_min : {0.5, 0.0}) {
    world::World world;
    scenes::add_outline(world, {{0.3, -5}, {1, -5}, {1, 5}, {0.3, 5}}, "wall");
    sensors::LaserSettings laser = scenes::laser(31, 0.5, 0.75);
    laser.range_min = range_min;
    laser.noise.range_sigma = 0.1;
    scenes::add_robot(world, {}, laser);
    world.movers[0].sensors.push_back(map_sensor());
    const Glance glance(world);
    ASSERT_EQ(glance.readings.back().type, sensors::kOccupancy);
    const auto words = glance.readings.back().values;
    EXPECT_EQ(std::all_of(words.begin(), words.end(), [](double word) { return word == 0.0; }), range_min > 0.0);
  }
}

TEST(OccupancySettings, Defaults) {
  const world::World world = mapped(1);
  const sensors::Occupancy map = only(world);
  EXPECT_EQ(map.row.rate, 1.0);
  EXPECT_EQ(map.row.elements, 900u);
  EXPECT_EQ(map.settings.grid.cell, 0.03);
  EXPECT_FALSE(map.settings.odds);
  EXPECT_EQ(map.settings.samples, 181u);
  EXPECT_EQ(map.settings.range_max, 0.75);
  const base::Pose& X = world.movers[0].X_WM;
  EXPECT_NEAR(map.settings.grid.left + 1.8, X.x, 0.0151) << "centred, to the cell";
  EXPECT_NEAR(map.settings.grid.top - 1.8, X.y, 0.0151);
  EXPECT_NEAR(std::remainder(map.settings.grid.left, 0.03), 0.0, 1e-9) << "on a lattice that all such maps share";
}

TEST(OccupancySettings, ReadsAllSettings) {
  const sensors::Occupancy map =
      only(mapped(1, {numbers("cell", {0.05}), numbers("words", {20, 10}), numbers("offset", {0.25, -1.75}),
                      numbers("rate", {2}), numbers("log_odds", {70, 30, 500}), text("laser", "laser")}));
  EXPECT_EQ(map.settings.grid, (maps::GridGeometry{-0.25, 1.75, 0.05, 20, 10})) << "the thesis' offset";
  EXPECT_EQ(map.row.rate, 2.0);
  EXPECT_EQ(*map.settings.odds, (maps::LogOddsUpdate{70, 30, 500}));
  EXPECT_EQ(*only(mapped(1, {numbers("log_odds", {1})})).settings.odds, maps::LogOddsUpdate{});
  EXPECT_FALSE(only(mapped(1, {numbers("log_odds", {0})})).settings.odds);
}

TEST(OccupancySettings, RejectsInvalidSettings) {
  expect_map_refused({numbers("cell", {0.0})}, "'cell' is 0");
  expect_map_refused({numbers("cell", {0.0005})}, "more than 1022 cells");
  expect_map_refused({numbers("words", {30})}, "[columns rows]");
  expect_map_refused({numbers("words", {30, 2.5})}, "whole numbers from 1 to 4096");
  expect_map_refused({numbers("words", {0, 30})}, "whole numbers from 1 to 4096");
  expect_map_refused({numbers("words", {4096, 257})}, "too large");
  expect_map_refused({numbers("offset", {1e8, 0})}, "change 'offset'");
  expect_map_refused({text("laser", "lidar")}, "has no laser 'lidar'; it has laser");
  expect_map_refused({numbers("log_odds", {2})}, "'log_odds' expects");
  expect_map_refused({numbers("log_odds", {1, 2})}, "'log_odds' expects");
  expect_map_refused({numbers("log_odds", {1.5, 2, 3})}, "'log_odds' expects");
  expect_map_refused({numbers("log_odds", {85, 40, 40000})}, "'log_odds' expects");
  expect_map_refused({numbers("log_odds", {85, 40, 0})}, "'log_odds' expects");
  world::World blind = mapped(1);
  scenes::remove_lasers(blind.movers[0]);
  EXPECT_THROW(sensors::occupancies_of(blind), base::InputError);
  world::World dense = mapped(1);
  scenes::edit_laser(dense.movers[0])->samples = 20'001;
  EXPECT_THROW(sensors::occupancies_of(dense), base::InputError);
}

/// Runs `ticks` tenths of seconds. Every delivered map must equal the map of the delivered scans.
std::size_t compare_run(const world::World& world, int ticks) {
  farm::Farm farm(world, device());
  farm.subscribe_all();
  const auto all = sensors::occupancies_of(world);
  std::vector<sensors::MapSettings> map_settings;
  for (const sensors::Occupancy& map : all) map_settings.push_back(map.settings);
  PlainMaps plain(map_settings);
  std::size_t compared = 0;
  for (int k = 0; k < ticks; ++k) {
    const auto readings = farm.tick(k * 100'000'000ll, farm::reports_at(world, k));
    for (const base::ReadingBlock& r : readings)
      for (std::uint32_t i = 0; i < all.size(); ++i)
        if (r.type == sensors::kLaser && all[i].row.mover == r.mover && all[i].laser == r.sensor)
          plain.update({i, r.X_WS, r.values});
    for (const base::ReadingBlock& r : readings) {
      if (r.type != sensors::kOccupancy) continue;
      const auto right = plain.words(r.mover);
      EXPECT_EQ(std::vector<double>(right.begin(), right.end()), std::vector<double>(r.values.begin(), r.values.end()));
      EXPECT_EQ(r.X_WS.x, all[r.mover].settings.grid.left);
      EXPECT_EQ(r.X_WS.y, all[r.mover].settings.grid.top);
      EXPECT_EQ(r.flags, maps::kTruePoses);
      ++compared;
    }
  }
  return compared;
}

TEST(OccupancyTick, MapsMatchTheScans) { EXPECT_EQ(compare_run(mapped(12), 31), 12u * 4) << "at 0, 1, 2 and 3 s"; }

TEST(OccupancyTick, LogOddsMatchTheScans) { EXPECT_EQ(compare_run(mapped(5, {numbers("log_odds", {1})}), 31), 5u * 4); }

TEST(OccupancyTick, FlagsAreClearForEstimatedPoses) {
  const world::World world = mapped(1);
  farm::FarmOptions options;
  options.true_poses = false;
  farm::Farm farm(world, device(), options);
  farm.subscribe_all();
  std::size_t seen = 0;
  for (const base::ReadingBlock& r : farm.tick(0, {}))
    if (r.type == sensors::kOccupancy) seen += r.flags == 0;
  EXPECT_EQ(seen, 1u);
}

TEST(OccupancyTick, MapWithoutSubscribersIsUpdated) {
  const world::World world = mapped(1);
  farm::Farm late(world, device()), early(world, device());
  early.subscribe_all();
  late.subscribe(0, 1u << sensors::kLaser);
  for (int k = 0; k < 10; ++k) late.tick(k * 100'000'000ll, farm::reports_at(world, k));
  late.subscribe_all();
  for (int k = 0; k < 10; ++k) early.tick(k * 100'000'000ll, farm::reports_at(world, k));
  const auto map_of = [](std::span<const base::ReadingBlock> readings) {
    std::vector<double> words;
    for (const base::ReadingBlock& r : readings)
      if (r.type == sensors::kOccupancy) words.assign(r.values.begin(), r.values.end());
    return words;
  };
  const auto early_map = map_of(early.tick(1'000'000'000, farm::reports_at(world, 10)));
  const auto late_map = map_of(late.tick(1'000'000'000, farm::reports_at(world, 10)));
  EXPECT_FALSE(early_map.empty());
  EXPECT_EQ(early_map, late_map);
}

TEST(OccupancyTick, DoesNotDependOnThreads) {
  const world::World world = mapped(20);
  std::uint64_t hashes[2] = {};
  for (const unsigned threads : {1u, 4u}) {
    farm::FarmOptions options;
    options.threads = threads;
    farm::Farm farm(world, device(), options);
    farm.subscribe_all();
    for (int k = 0; k < 11; ++k) farm.tick(k * 100'000'000ll, farm::reports_at(world, k));
    hashes[threads == 1 ? 0 : 1] = farm.hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(OccupancyTick, ValidationLayerIsSilent) {
  setenv("SENSORFARM_VALIDATE", "1", 1);
  {
    gpu::Device own;
    if (own.validation_messages().find("not installed") != std::string::npos)
      GTEST_SKIP() << "the validation layer is not installed";
    world::World world = mapped(6);
    world.movers[2].sensors.back().settings.push_back(numbers("log_odds", {1}));
    farm::Farm farm(world, own);
    for (int k = 0; k < 12; ++k) {
      for (std::uint32_t m = 0; m < 6; ++m) farm.subscribe(m, static_cast<int>(m) < k ? farm::kAllSensorTypes : 0u);
      farm.tick(k * 100'000'000ll, farm::reports_at(world, k));
    }
    EXPECT_EQ(own.validation_messages(), "");
  }
  unsetenv("SENSORFARM_VALIDATE");
}

// As packets.

sensors::SensorSpec map_row(std::uint32_t columns, std::uint32_t rows) {
  sensors::SensorSpec row;
  row.elements = columns * rows;
  row.across = columns;
  row.pitch = 0.03;
  return row;
}

std::vector<double> any_words(std::uint32_t count, std::uint64_t seed) {
  Chance chance(seed);
  std::vector<double> words;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t word = 0;
    for (unsigned k = 0; k < 32; k += 2) word |= chance.below(3) << k;
    words.push_back(word);
  }
  return words;
}

TEST(OccupancyPackets, RoundTripInBothForms) {
  const sensors::SensorType& type = sensors::occupancy_type;
  for (const auto& [columns, rows] : {std::pair{30u, 30u}, {1u, 1u}, {67u, 5u}, {7u, 146u}}) {
    const sensors::SensorSpec row = map_row(columns, rows);
    const auto words = any_words(row.elements, columns);
    base::ReadingBlock reading;
    reading.values = words;
    reading.flags = maps::kTruePoses;
    for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis}) {
      ASSERT_EQ(type.wire_problem(row, wire), "");
      std::vector<double> back(words.size(), -1.0);
      const std::uint32_t parts = type.parts(row, wire);
      for (std::uint32_t p = 0; p < parts; ++p) {
        base::Bytes bytes;
        ASSERT_EQ(type.encode(row, reading, wire, p, bytes), type.id);
        ASSERT_LE(bytes.size(), wire == WireFormat::farm ? 1376u : 2046u);
        const sensors::PayloadPart part = type.decode(row, bytes, type.id, wire);
        ASSERT_EQ(part.fault, sensors::PayloadError::none);
        ASSERT_EQ(part.part, p);
        ASSERT_EQ(part.parts, parts);
        type.read(row, bytes, type.id, wire, back);
      }
      ASSERT_EQ(back, words) << columns << " x " << rows;
    }
  }
}

TEST(OccupancyPackets, RejectsMapsOfOtherSensors) {
  const sensors::SensorType& type = sensors::occupancy_type;
  const auto words = any_words(900, 3);
  base::ReadingBlock reading;
  reading.values = words;
  base::Bytes bytes;
  type.encode(map_row(30, 30), reading, WireFormat::farm, 0, bytes);
  EXPECT_EQ(type.decode(map_row(30, 30), bytes, type.id, WireFormat::farm).fault, sensors::PayloadError::none);
  EXPECT_EQ(type.decode(map_row(25, 36), bytes, type.id, WireFormat::farm).fault, sensors::PayloadError::out_of_range);
  EXPECT_EQ(type.decode(map_row(30, 29), bytes, type.id, WireFormat::farm).fault, sensors::PayloadError::out_of_range);
  EXPECT_EQ(type.decode(map_row(30, 30), bytes, 3, WireFormat::farm).fault, sensors::PayloadError::out_of_range);
  EXPECT_EQ(type.decode(map_row(0, 0), bytes, type.id, WireFormat::farm).fault, sensors::PayloadError::none)
      << "the sensor is unknown";
  base::Bytes plain;
  type.encode(map_row(30, 30), reading, WireFormat::thesis, 0, plain);
  EXPECT_EQ(type.decode(map_row(25, 36), plain, type.id, WireFormat::thesis).fault,
            sensors::PayloadError::out_of_range);
}

TEST(OccupancyPackets, ThesisFormIsLimitedToSmallMaps) {
  const sensors::SensorType& type = sensors::occupancy_type;
  EXPECT_EQ(type.wire_problem(map_row(7, 146), WireFormat::thesis), "") << "1022 words";
  EXPECT_NE(type.wire_problem(map_row(32, 32), WireFormat::thesis), "");
  EXPECT_NE(type.wire_problem(map_row(256, 1), WireFormat::thesis), "");
  EXPECT_EQ(type.wire_problem(map_row(1024, 1024), WireFormat::farm), "");
}

}  // namespace
}  // namespace sf::trial
