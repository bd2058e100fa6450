// A robot's own map: its settings, its scans, and the packets read by `sensorfarm map`.

#include "server/own_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "maps/map_assembler.h"
#include "maps/map_packets.h"
#include "netio/packets.h"
#include "netio/socket.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "tests/refusal.h"
#include "tests/robots/scenes.h"

namespace sf::server {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

sensors::LaserSettings map_laser() {
  sensors::LaserSettings laser;
  laser.samples = 91;
  laser.range_max = 2.0;
  laser.X_MS = {0.1, 0.0, 0.1, 0.2};
  return laser;
}

/// A room of 6 m by 4 m with a Create that turns in place.
world::World map_world(std::vector<world::Setting> settings = {}, bool has_map = false) {
  world::World world = scenes::boxed_world(6.0, 4.0, {-3.0, -2.0});
  world::Mover& robot = scenes::add_create(world, {-1.0, 0.5, 0.0, 0.3});
  robot.sensors.push_back(sensors::laser_sensor(map_laser()));
  if (has_map) robot.sensors.push_back({.type = "occupancy", .name = "map", .settings = std::move(settings)});
  world::update_extent_and_hash(world);
  return world;
}

struct MapTest : testing::Test {
  OwnMapOptions options(sensors::WireFormat wire = sensors::WireFormat::farm) const {
    return {netio::bound_endpoint(receiver), wire};
  }
  OwnMap map_of(const world::World& world, sensors::WireFormat wire = sensors::WireFormat::farm) const {
    return OwnMap(world, sensors::SensorSet(world), 0, options(wire));
  }
  /// Returns the datagrams received since the last call.
  std::vector<base::Bytes> datagrams() {
    std::vector<base::Bytes> all;
    batch.drain(receiver, 10'000, [&](std::span<const std::uint8_t> bytes, const netio::Endpoint&) {
      all.emplace_back(bytes.begin(), bytes.end());
    });
    return all;
  }
  /// @return number of complete maps so far
  std::uint64_t receive() {
    for (const base::Bytes& bytes : datagrams()) {
      EXPECT_EQ(netio::decode(bytes, packet), netio::PacketStatus::accepted);
      assembler.add_part(packet.header.sequence, std::get<netio::Reading>(packet.body).payload);
    }
    return assembler.complete_maps();
  }
  base::ReadingBlock scan(std::int64_t time) const { return {.type = sensors::kLaser, .time = time, .values = ranges}; }

  netio::Socket receiver = netio::open_udp({netio::kLoopback, 0}, {.receive = 1u << 20});
  netio::ReceiveBatch batch{64};
  maps::MapAssembler assembler;
  netio::Packet packet;
  std::vector<double> ranges = std::vector<double>(91, 1.2);
};

TEST_F(MapTest, SendsTheMapOfItsScans) {
  const world::World world = map_world();
  OwnMap map(world, sensors::SensorSet(world), 0, options());
  map.send(0, true);
  EXPECT_EQ(receive(), 0u) << "no scan yet";

  const base::Pose X_WM{-1.0, 0.5, 0.0, 0.3}, further{-0.5, 0.6, 0.0, 0.8};
  ranges[40] = 0.4;
  map.add(scan(kSecond), X_WM);
  ranges[41] = 2.0;  // no return
  map.add(scan(2 * kSecond), further);
  map.send(2 * kSecond, true);
  ASSERT_EQ(receive(), 1u);

  const maps::GridGeometry& grid = assembler.map()->geometry;
  EXPECT_LE(grid.left, world.extent.x_min);
  EXPECT_GE(grid.top, world.extent.y_max);
  EXPECT_GE(grid.left + grid.cell * static_cast<double>(maps::columns(grid)), world.extent.x_max);
  EXPECT_LE(grid.top - grid.cell * static_cast<double>(maps::rows(grid)), world.extent.y_min);
  EXPECT_EQ(grid.cell, 0.03);
  maps::OccupancyGrid expected(grid);
  const std::vector<glm::dvec2> beams = maps::beam_directions(map_laser().fov, 91);
  for (const base::Pose& X : {X_WM, further}) {
    ranges[41] = X.x == further.x ? 2.0 : 1.2;
    maps::add_scan(expected, {base::compose(X, map_laser().X_MS), ranges, beams, 0.0, 2.0});
  }
  EXPECT_EQ(assembler.map()->words, expected.words);
  EXPECT_TRUE(assembler.true_poses());
  EXPECT_EQ(packet.header.type, netio::Type{sensors::kOccupancy});
  EXPECT_EQ(packet.header.robot, world.movers[0].id);
  EXPECT_NE(packet.header.session, 0u);
  EXPECT_EQ(map.counts().scans, 2u);
}

TEST_F(MapTest, HasTheSourcesOfItsWorld) {
  world::World world = map_world({{"sources", {}, "laser", 0, ""}}, true);
  OwnMap map = map_of(world);
  const base::Pose X_WM{-1.0, 0.5, 0.0, 0.3};
  map.add(scan(kSecond), X_WM);
  map.add(scan(kSecond), X_WM);  // repeated
  EXPECT_EQ(map.counts().scans, 1u);
  const maps::OccupancyGrid grid = map.grid();
  const base::Pose X_WS = base::compose(X_WM, map_laser().X_MS);
  const auto at = [&](double range) {
    return grid.at(maps::cell_at(grid.geometry, base::transform(X_WS, {range, 0.0})));
  };
  EXPECT_EQ(at(0.6), maps::Cell::free);
  EXPECT_EQ(at(1.4), maps::Cell::unexplored);

  world::Mover& other = scenes::add_create(world, {1.0, 0.5, 0.0, 0.3});
  other.sensors.push_back(sensors::laser_sensor(map_laser()));
  world.movers[0].sensors.back().settings[0].text = "*/laser";
  world::update_extent_and_hash(world);
  expect_in("has sources of other robots, whose readings it does not receive", refusal_of([&] { map_of(world); }));
}

TEST_F(MapTest, IsSentAtItsRate) {
  OwnMap map = map_of(map_world());
  map.add(scan(0), {});
  for (std::int64_t time = 0; time < 3 * kSecond; time += kSecond / 10) map.send(time, false);
  EXPECT_EQ(receive(), 3u);
  EXPECT_EQ(map.counts().maps, 3u);
  EXPECT_FALSE(assembler.true_poses());
}

/// At the map's rate, with the pose at the newest scan, and without packets.
TEST_F(MapTest, IsShownWithoutAReceiver) {
  std::vector<std::uint32_t> words;
  std::vector<double> places;
  OwnMapOptions shown;
  shown.show = [&](const maps::OccupancyGrid& grid, const base::Pose& X_WM) {
    words = grid.words;
    places.push_back(X_WM.x);
  };
  const world::World world = map_world();
  OwnMap map(world, sensors::SensorSet(world), 0, shown), sent(world, sensors::SensorSet(world), 0, options());
  map.send(0, true);
  EXPECT_TRUE(places.empty()) << "no scan yet";
  for (std::int64_t time = 0; time < 2 * kSecond; time += kSecond / 4)
    for (OwnMap* each : {&map, &sent}) {
      each->add(scan(time), {1e-9 * static_cast<double>(time), 0.5, 0.0, 0.0});
      each->send(time, true);
    }
  EXPECT_EQ(places, (std::vector<double>{0.0, 1.0}));
  EXPECT_EQ(receive(), 2u) << "of the other map";
  EXPECT_EQ(words, assembler.map()->words);
  EXPECT_EQ(map.counts().maps, 2u);
  EXPECT_EQ(map.counts().sent.sent, 0u);
}

TEST_F(MapTest, AcceptsOnlyNewScansOfItsLaser) {
  OwnMap map = map_of(map_world());
  map.add(scan(kSecond), {});
  base::ReadingBlock other = scan(2 * kSecond);
  other.sensor = 1;
  map.add(other, {});
  other = scan(2 * kSecond);
  other.type = sensors::kLaser + 1;
  map.add(other, {});
  map.add(scan(kSecond), {});      // a duplicate
  map.add(scan(kSecond - 1), {});  // older
  ranges.pop_back();
  map.add(scan(3 * kSecond), {});  // of another length
  EXPECT_EQ(map.counts().scans, 1u);
  ranges.assign(91, NAN);
  map.add(scan(4 * kSecond), {1e9, 0, 0, 0});  // far outside
  map.send(4 * kSecond, false);
  EXPECT_EQ(receive(), 1u);
}

TEST_F(MapTest, UsesTheSettingsOfItsOccupancy) {
  OwnMap map =
      map_of(map_world({{"cell", {0.1}, "", 0, ""}, {"words", {4, 3}, "", 0, ""}, {"rate", {5}, "", 0, ""}}, true));
  EXPECT_EQ(map.settings().settings.grid.word_columns, 4u);
  EXPECT_EQ(map.settings().settings.grid.cell, 0.1);
  map.add(scan(0), {});
  for (std::int64_t time = 0; time < kSecond; time += kSecond / 10) map.send(time, false);
  EXPECT_EQ(receive(), 5u);
}

TEST_F(MapTest, SendsTheThesisLayout) {
  OwnMap map = map_of(map_world({{"words", {30, 30}, "", 0, ""}}, true), sensors::WireFormat::thesis);
  map.add(scan(0), {-1, 0.5, 0, 0});
  map.send(0, true);
  for (const base::Bytes& bytes : datagrams()) assembler.add_plain_part(bytes);
  EXPECT_EQ(assembler.complete_maps(), 1u);
}

TEST_F(MapTest, LargeWorldsAndRangesGetLargerCells) {
  world::World world = map_world();
  world.extent = {-4000.0, -4000.0, 4000.0, 4000.0};
  const OwnMap wide = map_of(world);
  EXPECT_TRUE(maps::is_valid(wide.settings().settings.grid));
  EXPECT_EQ(wide.settings().settings.grid.cell, 3.84) << "3 cm times 128: at most 1024 x 1024 words of 4 cells";
  world = map_world();
  sensors::LaserSettings far = map_laser();
  far.range_max = 80.0;
  world.movers[0].sensors = {sensors::laser_sensor(far)};
  EXPECT_EQ(map_of(world).settings().settings.grid.cell, 0.12) << "at most 1022 cells of range";
}

std::string map_refusal(const world::World& world, const OwnMapOptions& options) {
  return refusal_of([&] { OwnMap(world, sensors::SensorSet(world), 0, options); });
}

TEST_F(MapTest, RejectsUnsupportedMaps) {
  world::World blind = map_world();
  blind.movers[0].sensors.clear();
  EXPECT_NE(map_refusal(blind, options()).find("has no laser to build a map with"), std::string::npos);
  EXPECT_NE(map_refusal(map_world(), options(sensors::WireFormat::thesis)).find("does not fit the thesis' layout"),
            std::string::npos);
}

}  // namespace
}  // namespace sf::server
